"""What people type in the first hour, with what it should lead to: the exit code and a part of the answer."""

from __future__ import annotations

AT = "0,-90,90,0,30,0"
# What each command that reads a machine needs beside it.
NEEDS = {
    "info": "",
    "check": "",
    "fk": f"--at {AT}",
    "ik": "--poses poses.csv",
    "couple": "",
    "crosscheck": "--solver opw --count 3 --samples random",
    "urdf": "-o out",
    "export": "--format urdf -o out",
    "as-universal": "-o list.lis",
    "inspect": "--export page.html",
    "picture": "-o m.svg",
    "singularity": f"--at {AT}",
    "collide": f"--at {AT}",
    "limits": "--axis A3 --over A2 --steps 1",
    "workspace": "--samples 50 --cells 3 --workers 1",
    "demo": "-o out",
}
# Mistakes with the machine and how it is chosen, for every such command; NEEDS stands for the above.
EVERYWHERE = """
kr6r90 NEEDS => 1 did you mean kr6r900?
folder NEEDS => 1 folder: this is a folder
empty.lis NEEDS => 1 the file is empty
notes.txt NEEDS => 1 notes.txt:1:
- NEEDS => 2 a machine file is named
kr6r900 NEEDS --nope => 2 Unknown option: --nope
kr6r900 NEEDS --kinematic => 2 --kinematic requires an argument: Configured id or name
kr6r900 NEEDS --kinematic 99 => 1 no kinematic '99'; permitted: 1 (ROBX)
kr6r900 NEEDS --channel 7 => 1 channel 7
kr6r900 NEEDS --tool-length 5mm => 2 --tool-length 5mm: expected a number with a decimal point, without a unit
kr6r900 NEEDS --convention c_offst=a => 1 unknown convention 'c_offst'; permitted: c_offset
kr6r900 NEEDS --overlay missing.toml => 1 missing.toml: no such file
kr6r900 irb2600 NEEDS => 2 unexpected argument irb2600; expected one machine
"""
# Habits with the machine, for every such command: all of these are right.
HABITS = """
NEEDS kr6r900
./copy.tea NEEDS
NEEDS "my arm.tea"
kr6r900 NEEDS --kinematic 1
kr6r900 --kinematic=ROBX NEEDS
kr6r900 NEEDS --kinematic 1 --channel 1
kr6r900 NEEDS --tool-length 100
--tool_length=1e2 kr6r900 NEEDS
kr6r900 NEEDS --convention singularity_measure=product
--convention=singularity_measure=product --convention axes_dir_index=internal kr6r900 NEEDS
given/kr6r900/kr6r900.urdf NEEDS --tool tool
arm.csv NEEDS
"""
# Mistakes and habits of one command, or with several.
ALONE = """
nope => 2 Unknown command "nope"
kr6r900 => 2 the command comes before the machine: chainbuild info kr6r900
kr6r900 fk --at 0,0,0,0,0,0 => 2 chainbuild fk kr6r900 --at 0,0,0,0,0,0
copy.tea => 2 the command comes before the machine: chainbuild info copy.tea
--json info kr6r900 => 2 options stand behind the command: chainbuild info --json kr6r900
help => 2 Did you mean "chainbuild --help"?
help fk => 2 Did you mean "chainbuild fk --help"?
INFO kr6r900 => 2 Did you mean "chainbuild info"?
version => 2 Did you mean "chainbuild --version"?
as_universal bed_mill_kin1 => 2 Did you mean "chainbuild as-universal"?
validate copy.tea => 2 Did you mean "chainbuild check"?
show kr6r900 => 2 Did you mean "chainbuild inspect"?
plot kr6r900 => 2 Did you mean "chainbuild picture"?
convert kr6r900 => 2 Did you mean "chainbuild export"?
-V => 0 .
--version => 0 .
-h => 0 Usage: chainbuild COMMAND
info -h => 0 Usage: chainbuild info
info --help kr6r900 => 0 Usage: chainbuild info
info => 2 FILE requires an argument: A machine file, or the name of a shipped machine
info kr6r900 --JSON => 2 did you mean --json?
info kr6r900 --defaults yes => 2 unexpected argument yes; --defaults takes no value
info kr6r900 --json=true => 0 "chainbuild:info:1"
info kr6r900 -v => 2 permitted: --defaults, --json
info KR6R900 => 1 did you mean kr6r900?
info '' => 1 the name of the machine file is empty
info missing/a.lis => 1 missing/a.lis: no such file: the folder does not exist
info kr6r900 --Channel 1 => 2 --channel
info kr6r900 --channel one => 2 --channel one: expected a whole number, without a unit
info kr6r900 --tool-length 5,5 => 2 --tool-length 5,5: expected a number with a decimal point
info kr6r900 --convention c_offset => 2 --convention c_offset: expected NAME=CHOICE
check KR6R900 => 1 did you mean kr6r900?
check '' => 1 the name of the machine file is empty
check missing/a.lis => 1 missing/a.lis: no such file: the folder does not exist
check kr6r900 --Channel 1 => 2 --channel
check kr6r900 --channel one => 2 --channel one: expected a whole number, without a unit
check kr6r900 --tool-length 5,5 => 2 --tool-length 5,5: expected a number with a decimal point
check kr6r900 --convention c_offset => 2 --convention c_offset: expected NAME=CHOICE
check copy.tea => 0 accepted
check => 2 FILE requires an argument
check '*.lis' => 1 *.lis: no such file
check notes.txt => 1 refused
types 9.0 => 0 KIN_TYP 9
types 9.7 => 2 KIN_TYP 9.7: expected a whole number
types KIN9 => 2 KIN_TYP KIN9: expected a whole number
types 9,58 => 2 expected a whole number
types 9 58 => 2 unexpected argument 58
types 44 => 1 permitted: KIN_TYP 1, 2
types -1 => 1 permitted: KIN_TYP 1, 2
types --json --nope => 2 permitted: --json
warm kr6r900 => 2 unexpected argument kr6r900
completion tcsh => 2 Choose from: "bash", "zsh", "fish"
completion bash zsh => 2 unexpected argument zsh
fk kr6r900 => 2 expected axis values: --at 0,-90,90, or a table: --axes TABLE.csv
fk kr6r900 --at -10,-90,90,0,30,0 => 0 x_mm
fk kr6r900 --at=-10,-90,90,0,30,0 => 0 x_mm
fk --at 0,-90,90,0,30,0 kr6r900 => 0 x_mm
fk kr6r900 --at '0, -90, 90, 0, 30, 0' => 0 x_mm
fk kr6r900 --at '0 -90 90 0 30 0' => 0 x_mm
fk kr6r900 --at '[0, -90, 90, 0, 30, 0]' => 0 x_mm
fk kr6r900 --at '0,5;-90;90;0;30;0' => 0 x_mm
fk kr6r900 --at −10,−90,90,0,30,0 => 0 x_mm
fk kr6r900 --at 0,0,0,0,0,0 --at 0,0,0,0,0,1 => 0 x_mm
fk kr6r900 --axes path.csv -o - => 0 x_mm
fk kr6r900 --axes path.csv --at 0,0,0,0,0,0 => 0 x_mm
fk kr6r900 --at 400,-90,90,0,30,0 => 0 1 row outside the limits of A1
fk kr6r900 --axes header.csv => 0 header.csv: the table has no rows
fk kr6r900 --at 0,-90,90 => 1 expected 6 axis values, got 3; permitted: A1, A2, A3, A4, A5, A6
fk kr6r900 --at 0,5,-90,0,90,0,0,0,30,0,0,0 => 1 a decimal is written with a point
fk kr6r900 --at 0 -90 90 0 30 0 => 2 write several values as one word with commas
fk kr6r900 0,-90,90,0,30,0 => 2 did you mean --at 0,-90,90,0,30,0?
fk kr6r900 path.csv => 2 did you mean --axes path.csv?
fk kr6r900 --at path.csv => 2 a table is given with --axes path.csv
fk kr6r900 --axes 0,-90,90,0,30,0 => 2 axis values are given with --at 0,-90,90,0,30,0
fk kr6r900 --at 0mm,-90,90,0,30,0 => 2 without units: linear axes are in mm, rotary ones in degrees
fk kr6r900 --at 0°,-90°,90°,0,30,0 => 2 without units
fk kr6r900 --at '0,5 -90,0 90,0 0,0 30,0 0,0' => 2 a decimal is written with a point
fk kr6r900 --at A1=0,A2=-90,A3=90,A4=0,A5=30,A6=0 => 2 without names, in the order A1, A2, A3, A4, A5, A6
fk kr6r900 --at 0,,90,0,30,0 => 2 expected numbers separated by commas
fk kr6r900 --at 0,-90,90,0,30,nan => 1 axis A6 has the value nan; permitted: finite numbers
fk kr6r900 --at => 2 --at requires an argument: Axis values in channel order
fk kr6r900 --axis path.csv => 2 Did you mean --axes?
fk kr6r900 --axes missing.csv => 1 permitted: a table whose first line is A1,A2,A3,A4,A5,A6
fk kr6r900 --axes poses.csv => 1 unknown column 'x_mm'; permitted: A1, A2, A3, A4, A5, A6; this is a table of poses
fk kr6r900 --axes folder => 1 folder:
fk kr6r900 --axes path.csv -o path.csv => 2 path.csv is also the input; expected another file, nothing was written
fk kr6r900 --axes path.csv -o folder => 1 folder: the file cannot be written: this is a folder; expected a file
fk kr6r900 --axes path.csv -o no/x.csv => 1 no/x.csv: the file cannot be written: there is no folder no; make it first
fk kr6r900 --axes path.csv -o /proc/x.csv => 1 /proc/x.csv: the file cannot be written
fk kr6r900 --axes path.csv -o => 2 -o requires an argument: CSV table of poses to write
fk kr6r900 --at 0,0,0,0,0,0 --json => 2 the output is text for programs already
fk kr6r900 --at 0,0,0,0,0,0 --angles zyx => 2 expected own, orirpy
ik kr6r900 --at 500,0,800,180,60,180 => 2 a pose is a row of a table, on an arm: printf 'x_mm,y_mm,
ik --at 0,0,0,0,0,0 => 2 Unknown option: --at; a pose is a row of a table
ik kr6r900 --poses path.csv => 1 this is a table of axis values: --axes reads it (fk, collide
ik kr6r900 --poses poses.csv -o - => 0 A1,A2
ik kr6r900 --poses=poses.csv --solver=analytic => 0 A1,A2
ik --poses poses.csv kr6r900 => 0 A1,A2
ik kr6r900 --poses poses_header.csv => 0 poses_header.csv: the table has no rows
ik kr6r900 => 2 --poses requires an argument: CSV table of poses
ik kr6r900 poses.csv => 2 did you mean --poses poses.csv?
ik kr6r900 --pose poses.csv => 2 Did you mean --poses instead of --pose?
ik kr6r900 --poses 517,0,890 => 2 --poses 517,0,890: expected a CSV table
ik kr6r900 --poses poses.csv --start 0,-90,90,0,30,0 => 2 --start 0,-90,90,0,30,0: expected a CSV table
ik kr6r900 --poses path.csv => 1 unknown column 'A1'; permitted: x_mm
ik kr6r900 --poses poses.csv --start poses.csv => 1 unknown column 'x_mm'; permitted: A1
ik kr6r900 --poses poses.csv --solver fast => 2 Choose from: "auto", "damped", "analytic", "controller"
ik kr6r900 --poses poses.csv --follow true => 2 --follow takes no value
ik kr6r900 --poses poses.csv -o poses.csv => 2 poses.csv is also the input
ik kr6r900 --poses far.csv => 3 far.csv:2: unreachable
urdf kr6r900 -o out --no_inertia => 0 out/kr6r900/kr6r900.urdf
urdf -o=out kr6r900 => 0 out/kr6r900/kr6r900.urdf
urdf kr6r900 out => 2 did you mean -o out?
urdf kr6r900 --out out => 2 Did you mean --output?
urdf kr6r900 --noinertia => 2 Did you mean --no-inertia?
urdf kr6r900 -o notes.txt => 1 notes.txt: the folder cannot be created: this is a file
urdf kr6r900 -o /proc/x => 1 the folder cannot be created
export kr6r900 --format URDF -o out => 0 out/kr6r900/kr6r900.urdf
export kr6r900 --format 'urdf, opw' -o out => 0 out/kr6r900/kr6r900.opw.yaml
export kr6r900 --format sdf => 2 expected all, or a list of urdf, mjcf, srdf, opw, report
export kr6r900 --format urdf mjcf => 2 did you mean --format urdf,mjcf?
export kr6r900 --format urdf --format mjcf => 2 Write several as one: --format urdf,mjcf
export kr6r900 mjcf => 2 did you mean --format mjcf?
export kr6r900 --formats urdf => 2 Did you mean --format?
export kr6r900 -f => 2 -f requires an argument: Formats, separated by commas
export kr6r900 --samples 1e-4 => 2 --samples 1e-4: expected a whole number
export kr6r900 --samples -5 => 2 --samples -5: expected at least 1
export tripod_kin12 --format opw -o out => 1 permitted: an ortho-parallel arm
export kr6r900 -o notes.txt => 1 notes.txt: the folder cannot be created: this is a file
as-universal bed_mill_kin1 -o - => 0 KIN_TYP 91
as-universal bed_mill_kin1 => 0 KIN_TYP 91
as-universal kr6r900 => 1 three linear ones must come first
as-universal bed_mill_kin1 list.lis => 2 did you mean -o list.lis?
as-universal bed_mill_kin1 --tool-length 5 => 2 the tool is no part of the list
as-universal bed_mill_kin1 -o no/l.lis => 1 there is no folder no
as-universal bed_mill_kin1 --json => 2 the output is text for programs already
inspect kr6r900 -o page.html => 2 did you mean --export?
inspect kr6r900 page.html => 2 did you mean --export page.html?
inspect kr6r900 --export => 2 --export requires an argument: HTML file to write
inspect kr6r900 --export folder => 1 folder: the file cannot be written: this is a folder
inspect kr6r900 --export p.html --port 80 => 2 an exported page has no server
inspect kr6r900 --port abc => 2 --port abc: expected a whole number
inspect kr6r900 --port 99999 --no-open => 1 permitted: 0 … 65535
inspect kr6r900 --token short --no-open => 1 permitted: 16 to 128
inspect kr6r900 --beside kr6r90 --no-open => 1 did you mean kr6r900?
inspect kr6r900 --export p.html --axes path.csv --poses poses.csv => 2 expected one table
inspect kr6r900 --export p.html --at 0,0 => 1 expected 6 axis values, got 2
picture kr6r900 -o M.SVG => 0 M.SVG
picture --output=m.svg kr6r900 --at '0 0 0 0 0 0' => 0 m.svg
picture kr6r900 => 2 --output requires an argument: Picture to write: NAME.svg or NAME.png
picture kr6r900 m.svg => 2 did you mean -o m.svg?
picture kr6r900 -o m.pdf => 1 permitted: .svg, .png
picture kr6r900 -o m => 1 permitted: .svg, .png
picture kr6r900 -o folder => 1 folder:
picture kr6r900 -o m.svg --view left => 2 Choose from: "iso", "front"
picture kr6r900 -o m.svg --dimension => 2 Did you mean --dimensions?
picture kr6r900 -o m.svg --at 0,0,0 => 1 expected 6 axis values, got 3
picture kr6r900 -o m.svg --axes header.csv => 1 header.csv: the table has no rows
singularity kr6r900 --at '0 -90 90 0 30 0' => 0 no singularity near
singularity kr6r900 --axes path.csv --feed=6000 => 0 Largest axis speeds
singularity kr6r900 => 2 expected --at, --axes or --poses, one of them
singularity kr6r900 path.csv => 2 did you mean --axes path.csv?
singularity kr6r900 0,-90,90,0,0,0 => 2 did you mean --at 0,-90,90,0,0,0?
singularity kr6r900 --at 0,0,0,0,0,0 --axes path.csv => 2 one of them
singularity kr6r900 --axes path.csv --feed -6000 => 1 wrong feed; permitted: a finite number above 0
singularity kr6r900 --axes path.csv --feed 6000mm/min => 2 --feed 6000mm/min: expected a number
singularity kr6r900 --axes path.csv --between line => 2 Choose from: "ptp", "cp", "rows"
singularity kr6r900 --axes path.csv --nearest => 2 --nearest requires --at or --between rows
singularity kr6r900 --axes header.csv => 1 header.csv: the table has no rows
singularity kr6r900 --axes path.csv --picture p.png => 2 expected NAME.svg: the picture is written as SVG
collide kr6r900 --axes path.csv --picture P.SVG => 0 no collision
collide kr6r900 => 2 expected --at, --axes, --pairs or --srdf
collide kr6r900 path.csv => 2 did you mean --axes path.csv?
collide kr6r900 --axes header.csv => 1 header.csv: the table has no rows
collide kr6r900 --at 0,0,0,0,0,0 --clearance -1 => 1 permitted: a finite length of at least 0
collide kr6r900 --at 0,0,0,0,0,0 --clearance 5mm => 2 --clearance 5mm: expected a number
collide kr6r900 --axes path.csv --between lin => 2 Choose from: "ptp", "cp", "rows"
collide kr6r900 --pairs --samples 0 => 1 at least 1 sample
collide kr6r900 --pair => 2 Did you mean --pairs?
collide kr6r900 --axes path.csv --picture p.png => 2 expected NAME.svg
collide kr6r900 --axes path.csv --picture path.csv => 2 path.csv is also the input
collide kr6r900 --srdf notes.txt => 1 notes.txt: the folder cannot be created: this is a file
limits kr6r900 --axis a3 --over a2 --steps 1 => 0 Free interval of A3
limits kr6r900 => 1 `limits --axis A --over B` sweeps one axis of any machine
limits kr6r900 --axis A3 => 2 --axis and --over must be given together
limits kr6r900 A3 A2 => 2 did you mean --axis A3 --over A2?
limits kr6r900 --axis A9 --over A2 => 1 no axis 'A9'; permitted: A1, A2
limits kr6r900 --axis A3 --over A3 => 1 an axis cannot be swept against itself
limits kr6r900 --axis A3 --over A2 --steps 0 => 2 --steps 0: expected at least 1
limits kr6r900 --axis A3 --over A2 --steps 5.5 => 2 --steps 5.5: expected a whole number
limits kr6r900 --axis A3 --over A2 --at 0,0 => 1 expected 6 axis values, got 2
limits kr6r900 --at 0,0,0,0,0,0 => 2 --at requires --axis and --over
workspace kr6r900 --samples 1e2 --cells 3 --workers 1 => 0 cells reached
workspace kr6r900 --samples 10k => 2 --samples 10k: expected a whole number
workspace kr6r900 --samples 0 => 1 the map has no samples; permitted: at least 1
workspace kr6r900 --section zr => 2 Choose from: "rz", "xz"
workspace kr6r900 --over A2 => 1 expected two different axes for this map; permitted: A1, A2
workspace kr6r900 --at 0,0,0,0,0,0 => 2 --at requires --over
workspace kr6r900 --cells 0 => 1 0 cells per side; permitted: 2
workspace kr6r900 --workers 0 => 2 --workers 0: expected at least 1
workspace kr6r900 map.npz => 2 did you mean -o map.npz?
workspace kr6r900 -o - => 2 the map is no text: expected NAME.npz
workspace kr6r900 -o no/m.npz => 1 there is no folder no
workspace kr6r900 --picture m.png => 2 expected NAME.svg
workspace kr6r900 -o path.csv --samples 50 => 1 it is no complete NPZ file
crosscheck kr6r900 --solver OPW --count 3 --samples random => 0 py-opw-kinematics
crosscheck kr6r900 => 2 expected either --solver or --recording
crosscheck kr6r900 path.csv => 2 did you mean --recording path.csv?
crosscheck kr6r900 --recording path.csv => 1 missing columns x_mm, y_mm, z_mm
crosscheck kr6r900 --recording missing.csv => 1 permitted: a table whose first line is A1,A2,A3,A4,A5,A6,x_mm
crosscheck kr6r900 --solver kdl => 1 unknown solver 'kdl'; permitted: eaik, opw
crosscheck kr6r900 --solver mod:fn => 1 'mod:fn' cannot be imported
crosscheck kr6r900 --solver opw --count 0 => 1 expected at least 1
crosscheck kr6r900 --solver opw --samples grids => 2 Did you mean "grid"?
crosscheck kr6r900 --solver opw --recording path.csv => 2 expected either --solver or --recording
crosscheck kr6r900 --solver opw --position-tolerance -1 => 1 a tolerance is out of range; permitted: more than 0
crosscheck kr6r900 --solver opw --html folder => 1 folder: the file cannot be written: this is a folder
couple robot_xy_unit_kin210 --tcp X=-700,Y=100 => 0 TCP
couple robot_xy_unit_kin210 --tcp X=700 Y=100 => 2 did you mean --tcp Y=100?
couple robot_xy_unit_kin210 X=700 => 2 did you mean --tcp X=700?
couple robot_xy_unit_kin210 --tcp X => 2 --tcp X: expected NAME=VALUE, VALUE a number
couple robot_xy_unit_kin210 --tcp X=700mm => 2 without a unit
couple robot_xy_unit_kin210 --tcp X=700,5 => 2 with a decimal point
couple robot_xy_unit_kin210 --tcp 700,100 => 2 --tcp 700: expected NAME=VALUE
couple robot_xy_unit_kin210 --tcp W=700 => 1 there is no coordinate W; permitted: X, Y, Z, A, B, C
couple robot_xy_unit_kin210 --lock FOO.X => 1 there is no partial FOO; permitted: LINEAR, ROBOT
couple robot_xy_unit_kin210 --program ROBOT=5 => 1 permitted: PARTIAL.LETTER, such as ROBOT.X
couple robot_xy_unit_kin210 --current X=5 => 2 expected PARTIAL.LETTER=VALUE or AXIS=VALUE
demo kr6r900 tx2_60 => 2 expected one machine
demo kr6r900 out => 2 did you mean -o out?
demo kr6r900 -o notes.txt => 1 notes.txt: the folder cannot be created: this is a file
demo kr6r900 -o => 2 -o requires an argument: Folder to write to
demo kr6r900 --format urdf => 2 permitted: --output
demo kr6r900 urdf.out => 2 did you mean -o urdf.out?
demo kr6r900 --output=notes.txt => 1 notes.txt: the folder cannot be created
demo --json => 2 permitted: --output
"""
