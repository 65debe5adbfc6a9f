// Drives the page: scene commands, camera, the sweep's clock and the axis table.
// A hash such as #t=3.5 opens the page paused at that second.
(function () {
  "use strict";
  const $ = (id) => document.getElementById(id);
  const page = JSON.parse($("page-data").textContent);
  const viewer = new MeshCat.Viewer($("pane"));
  // The viewer takes the window's height for its own; the pane may be lower.
  const resize = viewer.set_3d_pane_size.bind(viewer);
  viewer.set_3d_pane_size = () => resize($("pane").offsetWidth, $("pane").offsetHeight);
  for (const text of page.commands) {
    viewer.handle_command_bytearray(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)));
  }

  // Camera. Machine coordinates have z up, three.js has y up.
  const raised = ([x, y, z]) => new MeshCat.THREE.Vector3(x, z, -y);
  let moved = false;

  function fit() {
    viewer.set_3d_pane_size();
    const camera = viewer.camera;
    const [low, high] = page.bounds;
    const target = raised(low.map((v, n) => (v + high[n]) / 2));
    const back = raised(page.view).normalize();
    const right = new MeshCat.THREE.Vector3(0, 1, 0).cross(back).normalize();
    const up = back.clone().cross(right);
    camera.fov = 40;
    const tall = Math.tan((camera.fov * Math.PI) / 360);
    const wide = tall * camera.aspect;
    // Near enough that every corner of the swept box is inside the picture, and no nearer.
    let distance = 0;
    for (let n = 0; n < 8; n++) {
      const corner = raised([0, 1, 2].map((k) => ((n >> k) & 1 ? high[k] : low[k]))).sub(target);
      const across = Math.max(Math.abs(corner.dot(right)) / wide, Math.abs(corner.dot(up)) / tall);
      distance = Math.max(distance, across + corner.dot(back));
    }
    distance *= 1.04;
    camera.near = distance / 200;
    camera.far = distance * 50;
    camera.position.copy(target).addScaledVector(back, distance);
    camera.updateProjectionMatrix();
    viewer.controls.target.copy(target);
    viewer.controls.update();
    viewer.set_dirty();
  }
  viewer.controls.addEventListener("start", () => { moved = true; });
  window.addEventListener("resize", () => moved || fit());
  window.addEventListener("load", fit);

  // Clock.
  const animator = viewer.animator;
  const duration = (page.axes.length - 1) / page.fps;
  const rows = Array.from(document.querySelectorAll("#axes tbody tr"));
  let now = 0;

  const written = (value) => value.toFixed(1).replace("-", "\u2212");

  function show(time) {
    const place = Math.min(Math.max(time * page.fps, 0), page.axes.length - 1);
    const before = Math.min(Math.floor(place), page.axes.length - 2);
    const share = place - before;
    const values = page.axes[before].map((v, n) => v + share * (page.axes[before + 1][n] - v));
    const segment = page.segments.find((s) => place < s.last) || page.segments[page.segments.length - 1];
    rows.forEach((row, n) => {
      row.classList.toggle("moving", n === segment.axis);
      row.querySelector(".value").textContent = written(values[n]);
    });
    const axis = page.names[segment.axis];
    $("now").textContent = `Axis ${axis.name} moves: ${written(values[segment.axis])}${axis.unit}`;
    $("time").value = time;
    showPose(values);
  }

  // The tool in the workpiece frame, as the scene has it now: its joints turn at the keyframes' speed like the axes.
  const three = MeshCat.THREE;
  const cells = Array.from(document.querySelectorAll("#tcp td"));
  const [tool, workpiece] = [page.pose.tool, page.pose.workpiece].map(({ path, T }) => {
    const link = viewer.scene_tree.find(["meshcat", ...path]).object;
    const place = new three.Matrix4().set(...T);
    return () => {
      link.updateWorldMatrix(true, false);
      return new three.Matrix4().multiplyMatrices(link.matrixWorld, place);
    };
  });

  function showPose(axes) {
    const pose = workpiece().invert().multiply(tool());
    const position = new three.Vector3().setFromMatrixPosition(pose);
    const shown = displayed(axes, (i, j) => pose.elements[i + 4 * j]);
    const isVector = page.pose.display.kind === "vector";
    [...position.toArray().map((v) => 1000 * v), ...shown].forEach((value, n) => {
      const isUnit = isVector && n > 2;
      cells[n].textContent = isUnit ? value.toFixed(3) : written(Math.abs(value) < 0.05 ? 0 : value);
    });
  }

  // What the controller displays beside the position, for axis values and a rotation R(row, column); see kinematics/displayed.py.
  function displayed(axes, R) {
    const { kind, along, letters } = page.pose.display;
    const column = (n) => [0, 1, 2].map((row) => R(row, n));
    const degrees = (angle) => (angle * 180) / Math.PI;
    if (kind === "axes") return page.pose.display.axes.map((n) => axes[n]);
    if (kind === "vector") return column(along);
    if (kind === "plane") {
      const [x, y] = column(along);
      return [((degrees(Math.atan2(y, x)) - page.pose.display.zero + 540) % 360) - 180];
    }
    if (kind === "direction") return twoAngles(column(page.pose.display.tool)).map(degrees);
    if (kind === "position") return [];
    if (kind === "pitch") {
      const turn = (axes[0] * Math.PI) / 180;
      const [start, quarter] = page.pose.display.normals;
      const [x, y] = [0, 1].map((n) => Math.cos(turn) * start[n] + Math.sin(turn) * quarter[n]);
      const pitch = Math.atan2(y * R(0, 2) - x * R(1, 2), R(2, 2));
      return [pitch, Math.atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1))].map(degrees);
    }
    const angles = poseAngles(R);
    const sum = page.pose.absoluteC;
    if (sum) angles[2] = axes.reduce((total, v, n) => total + sum.coefficients[n] * v, sum.offset);
    return letters.map((letter) => angles["ABC".indexOf(letter)]);
  }

  // Two angles of a tool vector v = R1·R2·e in radians, the first within a quarter turn.
  function twoAngles(v) {
    const [i, j] = page.pose.display.turns.map((letter) => "ABC".indexOf(letter));
    const k = 3 - i - j;
    const sense = (j - i + 3) % 3 === 1 ? 1 : -1;
    const across = Math.hypot(v[j], v[k]);
    const pairs = [1, -1].map((side) => (page.pose.display.along === i
      ? [Math.atan2(side * v[j], -sense * side * v[k]), Math.atan2(side * across, v[i])]
      : [Math.atan2(-sense * side * v[j], side * v[k]), Math.atan2(sense * v[i], side * across)]));
    if (across < 1e-5) pairs.forEach((pair) => { pair[0] = 0; });
    return pairs.find(([first]) => first > -Math.PI / 2 && first <= Math.PI / 2) || pairs[0];
  }

  // A, B, C in degrees of a rotation R(row, column); at gimbal lock the first angle is 0.
  function poseAngles(R) {
    const factors = page.pose.factors;
    const [i, j, last] = factors.map(([axis]) => "xyz".indexOf(axis));
    const k = 3 - i - j;
    const parity = (j - i + 3) % 3 === 1 ? 1 : -1;
    const lock = 1e-5;  // keyframes are single precision
    let raw;
    if (i === last) {
      const sine = Math.hypot(R(j, i), R(k, i));
      raw = sine < lock
        ? [0, Math.atan2(sine, R(i, i)), Math.atan2(-parity * R(j, k), R(j, j))]
        : [Math.atan2(R(j, i), -parity * R(k, i)), Math.atan2(sine, R(i, i)), Math.atan2(R(i, j), parity * R(i, k))];
    } else {
      const cosine = Math.hypot(R(i, i), R(i, j));
      const middle = Math.atan2(parity * R(i, k), cosine);
      raw = cosine < lock
        ? [0, middle, Math.atan2(parity * R(j, i), R(j, j))]
        : [Math.atan2(-parity * R(j, k), R(k, k)), middle, Math.atan2(-parity * R(i, j), R(i, i))];
    }
    const angles = [0, 0, 0];
    factors.forEach(([, letter, sign], n) => { angles["ABC".indexOf(letter)] = (sign * raw[n] * 180) / Math.PI; });
    return angles;
  }

  function play() {
    animator.play();
    $("play").textContent = "Pause";
  }

  function pause() {
    animator.pause();
    $("play").textContent = "Play";
  }

  function seek(time) {
    now = Math.min(Math.max(time, 0), duration);
    animator.seek(now);
    show(now);
  }

  function tick() {
    if (animator.playing) {
      now = animator.time;
      show(now);
    }
    requestAnimationFrame(tick);
  }

  $("time").max = duration;
  $("time").addEventListener("input", () => { pause(); seek(Number($("time").value)); });
  $("play").addEventListener("click", () => (animator.playing ? pause() : play()));
  $("fit").addEventListener("click", () => { moved = false; fit(); });
  rows.forEach((row, n) => row.addEventListener("click", () => {
    seek(page.segments.find((s) => s.axis === n).first / page.fps);
    play();
  }));

  fit();
  const asked = /^#t=([0-9.]+)$/.exec(window.location.hash);
  if (asked) {
    pause();
    seek(Number(asked[1]));
  } else {
    show(0);
    play();
  }
  tick();
})();
