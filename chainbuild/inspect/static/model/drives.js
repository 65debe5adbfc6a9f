export const driveMap = () => ({ drives: (axes) => axes.slice() });
