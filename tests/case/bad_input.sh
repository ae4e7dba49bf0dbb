#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Whatever is wrong with a case or a command line gives one message that says
# what and where, exit status 2, and leaves no file. Usage: bad_input.sh BUILD
. "$(dirname "$0")/common.bash"
mkdir cases work

# A sound case: line 2 is the domain, 4 the grains, 5 the shape.
good='return { dimension = 2,
  domain = { size = 4, level = 5 },
  gravity = { 0, -1 },
  grains = { density = 1, rheology = { "mu_i", d = 0.05, eta_min = 0 },
    shape = function(x, y) return math.min(1 - x, 1 - y) end },
  gas = { density = 1e-3, rheology = { "newtonian", eta = 1e-4 } },
  boundary = { left = "symmetry", right = "no_slip", bottom = "no_slip",
    top = { "outflow", pressure = 0 } },
  output = { stop = 1 } }'

# refuses NAME PATTERN ARGUMENTS...: the program, started in work/, ends with
# status 2, writes nothing, and its one message matches PATTERN
refuses() {
  local name=$1 pattern=$2 status
  shift 2
  (cd work && timeout "$limit" "$build/talus" "$@") > all 2>&1
  status=$?
  own_words < all > output
  [ "$status" -eq 2 ] || complain "$name: exit status $status, not 2"
  [ "$(wc -l < output)" -eq 1 ] || complain "$name: not one line"
  grep -qE "^talus: error: .*$pattern" output ||
    complain "$name: the message does not match $pattern"
  if [ -n "$(ls -A work)" ]; then
    complain "$name: left $(ls -A work)"
    rm -rf work
    mkdir work
  fi
}

# bad_case NAME PATTERN TEXT: a whole case
bad_case() {
  echo "$3" > "cases/$1.lua"
  refuses "$1" "$2" run "../cases/$1.lua"
}

# bad_edit NAME PATTERN FROM TO: the sound case with one thing changed
bad_edit() {
  bad_case "$1" "$2" "${good/"$3"/$4}"
}

echo "$good" > cases/good.lua
(cd work && "$build/talus" check ../cases/good.lua) > output 2>&1 ||
  complain "the sound case is refused"

# keys and values of the table
bad_edit unknown_key \
  'unknown_key.lua:2: .*domain.levle = 5.*did you mean .level' \
  'level = 5' 'levle = 5'
bad_edit unknown_section 'unknown_section.lua:6: .*gass.*`gas`' 'gas =' 'gass ='
bad_edit missing_key 'missing_key.lua:2: domain.size is missing: a number > 0' \
  'size = 4, ' ''
bad_edit wrong_type 'wrong_type.lua:2: domain.size = "4": a number' \
  'size = 4' 'size = "4"'
bad_edit not_integer 'not_integer.lua:2: domain.level = 5.5: an integer' \
  'level = 5' 'level = 5.5'
bad_edit negative_density \
  'negative_density.lua:4: grains.density = -1: a number > 0' \
  'density = 1,' 'density = -1,'
bad_edit small_density \
  'small_density.lua:4: grains.density = 1e-13: grains.rheology.rho, .* 1e-12 to' \
  'density = 1,' 'density = 1e-13,'
bad_edit no_such_limiter \
  'no_such_limiter.lua:9: solver.limiter = "min": "none", "minmod" or "gener' \
  'output =' 'solver = { limiter = "min" }, output ='
bad_edit level_40 'level_40.lua:2: domain.level = 40: .*from 1 to 24' \
  'level = 5' 'level = 40'
bad_edit nan 'nan.lua:2: domain.size = -?nan: a number > 0' 'size = 4' \
  'size = 0/0'
bad_edit infinite 'infinite.lua:9: output.stop = inf: a number > 0' 'stop = 1' \
  'stop = math.huge'
bad_edit stop_0 'stop_0.lua:9: output.stop = 0: a number > 0' 'stop = 1' \
  'stop = 0'
bad_edit level_min 'level_min.lua:2: domain.level_min = 7 is above' \
  'level = 5' 'level = 5, level_min = 7'
bad_edit short_list 'short_list.lua:3: gravity: 2 numbers are needed, 1 given' \
  '{ 0, -1 }' '{ -1 }'
bad_edit long_list 'long_list.lua:3: gravity: 2 numbers are needed, 3 given' \
  '{ 0, -1 }' '{ 0, -1, 0 }'
bad_edit list_key 'list_key.lua:3: unknown key gravity.z = 1' \
  '{ 0, -1 }' '{ 0, -1, z = 1 }'
bad_edit closure 'closure.lua:4: grains.rheology = "mui": .*mu_i' '"mu_i"' \
  '"mui"'
bad_edit closure_key 'closure_key.lua:4: .*rheology.mus = 1.*mu_s' 'd = 0.05' \
  'd = 0.05, mus = 1'
bad_edit closure_missing 'closure_missing.lua:4: grains.rheology.d is missing' \
  'd = 0.05, ' ''
bad_edit closure_together \
  'closure_together.lua:4: grains.rheology: nu_min < nu_0 < nu_max' \
  '"mu_i", d = 0.05' '"lee_huang", nu_0 = 0.64'
bad_edit exact_cap 'exact_cap.lua:4: .*eta_max = 10 has no meaning with' \
  'eta_min = 0' 'eta_max = 10'
bad_case exact_theta 'exact_theta.lua:9: solver.theta = 0.5: .*"exact".* needs' \
  "$(sed 's/eta_min = 0/regularisation = "exact"/
    s/output =/solver = { theta = 0.5 }, output =/' <<< "$good")"
bad_edit exact_rate 'exact_rate.lua:4: .*gamma_r = 1 has .*say .*papanastasiou' \
  'eta_min = 0' 'gamma_r = 1'
bad_edit clip_rate 'clip_rate.lua:4: .*gamma_r = 1 has no meaning with .*"clip"' \
  'eta_min = 0' 'gamma_r = 1, regularisation = "clip"'
bad_edit nothing_to_hold \
  'nothing_to_hold.lua:4: .*"papanastasiou" has no meaning, as newtonian has no' \
  '"mu_i", d = 0.05' '"newtonian", eta = 1, regularisation = "papanastasiou"'
bad_edit exact_of_none 'exact_of_none.lua:4: .*"exact" needs a stress that holds' \
  '"mu_i", d = 0.05, eta_min = 0' '"newtonian", eta = 1, regularisation = "exact"'
bad_edit exact_of_creep 'exact_of_creep.lua:4: .*, and mu_i_well_posed has none' \
  '"mu_i", d = 0.05, eta_min = 0' \
  '"mu_i_well_posed", d = 0.05, regularisation = "exact"'
bad_edit exact_gas 'exact_gas.lua:6: .*"exact" is for the grains' \
  '"newtonian", eta = 1e-4' \
  '"bingham", tau_y = 1, eta_0 = 1, regularisation = "exact"'
bad_edit exact_name 'exact_name.lua:4: .*did you mean `?exact' \
  'eta_min = 0' 'regularisation = "exct"'
# coordinates
rings="${good/dimension = 2,/dimension = 2, coordinates = \"axisymmetric\",}"
# bad_rings NAME PATTERN FROM TO: the sound case around an axis, as bad_edit
bad_rings() {
  bad_case "$1" "$2" "${rings/"$3"/$4}"
}
echo "$rings" > cases/rings.lua
(cd work && "$build/talus" check ../cases/rings.lua) > output 2>&1 ||
  complain "the sound case around an axis is refused"
bad_edit coordinates_key \
  'coordinates_key.lua:1: unknown key axisymmetric = true; did you mean coordinates = "axisymmetric"' \
  'dimension = 2,' 'dimension = 2, axisymmetric = true,'
bad_edit coordinates_axi 'unknown key axi = 1; did you mean coordinates = ' \
  'dimension = 2,' 'dimension = 2, axi = 1,'
bad_edit coordinates_value \
  'coordinates = "axi": "cartesian" or "axisymmetric" is needed' \
  'dimension = 2,' 'dimension = 2, coordinates = "axi",'
bad_case rings_3d 'coordinates = "axisymmetric" is for dimension = 2' \
  "$(sed 's/dimension = 3,/&coordinates = "axisymmetric",/' \
    "$root/examples/box3d.lua")"
bad_rings rings_gravity 'rings_gravity.lua:3: gravity = .0.1, -1.*take .0, -1' \
  '{ 0, -1 }' '{ 0.1, -1 }'
bad_rings rings_origin 'rings_origin.lua:2: domain.origin.1. = -1' \
  'size = 4,' 'size = 4, origin = { -1, 0 },'
bad_rings rings_axis 'rings_axis.lua:7: boundary.left is the axis.*"symmetry"' \
  'left = "symmetry"' 'left = "no_slip"'
bad_rings rings_periodic 'boundary.left = "periodic": .* do not meet' \
  'left = "symmetry", right = "no_slip"' 'left = "periodic", right = "periodic"'
bad_rings rings_walls 'rings_walls.lua:4: grains.side_walls: they stand across' \
  'density = 1,' 'density = 1, side_walls = { mu = 0.2, width = 1 },'
bad_edit strip_length 'boundary.bottom.length is missing: a number >= 0' \
  'bottom = "no_slip"' 'bottom = { "slip_strip" }'
bad_edit strip_negative 'boundary.bottom.length = -1: a number >= 0 is needed' \
  'bottom = "no_slip"' 'bottom = { "slip_strip", length = -1 }'
bad_edit strip_patch 'boundary.patches.a: a patch cannot be a slip_strip' \
  'bottom = "no_slip"' \
  'bottom = function(x, y) return x < 1 and "a" or "no_slip" end,
    patches = { a = { "slip_strip", length = 1 } }'
bad_case strip_alone 'strip_alone.lua:5: boundary.bottom = "slip_strip" has gas' \
  'return { dimension = 2, domain = { size = 4, level = 5 }, gravity = { 0, -1 },
  grains = { density = 1, rheology = { "newtonian", eta = 1 } },
  boundary = { left = "symmetry", right = "no_slip",
    top = { "outflow", pressure = 0 },
    bottom = { "slip_strip", length = 1 } }, output = { stop = 1 } }'
bad_edit walls_width 'walls_width.lua:4: grains.side_walls.width is missing' \
  'density = 1,' 'density = 1, side_walls = { mu = 0.2 },'
bad_edit walls_key 'walls_key.lua:4: unknown key grains.side_walls.w = 1' \
  'density = 1,' 'density = 1, side_walls = { mu = 0.2, w = 1 },'
bad_case walls_3d 'walls_3d.lua:1: grains.side_walls is for two dimensions' \
  'return { dimension = 3, grains = { side_walls = { mu = 0.2, width = 1 },
    density = 1, rheology = { "bagnold", d = 0.1 } }, gravity = { 0, 0, -1 },
  domain = { size = 1, level = 2 }, output = { stop = 1 },
  boundary = { left = "slip", right = "slip", front = "slip", back = "slip",
    bottom = "slip", top = "outflow" } }'
bad_edit viscosity_missing \
  'viscosity_missing.lua:4: grains.rheology.viscosity is missing' \
  '"mu_i", d = 0.05' '"user"'
bad_edit viscosity_number \
  'viscosity_number.lua:4: grains.rheology.viscosity = 3: a function' \
  '"mu_i", d = 0.05' '"user", viscosity = 3'
bad_edit viscosity_key \
  'viscosity_key.lua:4: unknown key grains.rheology.viscosity' \
  'd = 0.05' 'd = 0.05, viscosity = 3'
bad_edit viscosity_nil \
  'viscosity_nil.lua:4: .*rheology.viscosity\(0, 0, 0\) returned nil' \
  '"mu_i", d = 0.05' '"user", viscosity = function() end'
bad_edit viscosity_nan 'viscosity_nan.lua:4: .*\(0, 0, 0\) returned -?nan' \
  '"mu_i", d = 0.05' '"user", viscosity = function(g, p) return p / g end'
bad_edit viscosity_negative \
  'viscosity_negative.lua:4: .*viscosity\(1, 1000, 0\) returned -999' \
  '"mu_i", d = 0.05' \
  '"user", viscosity = function(g, p) return g == 1 and p > 9 and g - p or 1 end'
bad_edit viscosity_fails 'viscosity_fails.lua:4: .*fails: .*attempt to index' \
  '"mu_i", d = 0.05' '"user", viscosity = function(g) return g.x end'
bad_edit boundary 'boundary.lua:7: boundary.left = "symetry": .*symmetry' \
  'left = "symmetry"' 'left = "symetry"'
bad_edit periodic 'periodic.lua:7: .*right must be "periodic" too' \
  'left = "symmetry"' 'left = "periodic"'
bad_case no_pressure 'no_pressure.lua:4: .*add boundary.pressure_level' \
  'return { dimension = 2, domain = { size = 1, level = 3 }, gravity = { 0, -1 },
  grains = { density = 1, rheology = { "coulomb", mu_s = 1 } },
  output = { stop = 1 },
  boundary = { left = "slip", right = "slip", bottom = "slip", top = "slip" } }'
outlet='{ "outflow", pressure = 0 }'
bad_edit pressure_text \
  'pressure_text.lua:8: boundary.pressure_level = "gas": .*at = "gas"' \
  "$outlet" '"no_slip", pressure_level = "gas"'
bad_edit pressure_nan 'pressure_nan.lua:8: boundary.pressure_level = .*nan' \
  "$outlet" '"no_slip", pressure_level = { 0/0, at = "gas" }'
bad_edit pressure_alone 'pressure_alone.lua:8: boundary.pressure_level.at = nil' \
  "$outlet" '"no_slip", pressure_level = { 0 }'
bad_edit pressure_key 'pressure_key.lua:8: unknown key .*did you mean .at' \
  "$outlet" '"no_slip", pressure_level = { 0, att = "gas" }'
bad_edit pressure_place \
  'pressure_place.lua:8: boundary.pressure_level.at = "gass": .*"gas"' \
  "$outlet" '"no_slip", pressure_level = { 0, at = "gass" }'
bad_edit pressure_axes 'pressure_axes.lua:8: .*2 numbers are needed, 3 given' \
  "$outlet" '"no_slip", pressure_level = { 0, at = { 1, 1, 1 } }'
bad_edit pressure_outside \
  'pressure_outside.lua:8: .*outside the box: its y is 4.1, allowed is 0 to 4' \
  "$outlet" '"no_slip", pressure_level = { 0, at = { 1, 4.1 } }'
bad_case pressure_gas 'pressure_gas.lua:4: .*there is no gas' \
  'return { dimension = 2, domain = { size = 1, level = 3 }, gravity = { 0, -1 },
  grains = { density = 1, rheology = { "coulomb", mu_s = 1 } },
  output = { stop = 1 }, boundary = { left = "slip", right = "slip",
    bottom = "slip", top = "slip", pressure_level = { 0, at = "gas" } } }'
bad_edit no_side 'no_side.lua:7: boundary.left is missing' \
  'left = "symmetry", ' ''
bad_edit patch 'patch.lua:8: boundary.top.*"hole", which boundary.patches' \
  '{ "outflow", pressure = 0 }' \
  'function() return "hole" end, patches = { outlet = "outflow" }'
bad_edit criterion 'criterion.lua:9: adapt\[1\] = "interfase": .*interface' \
  'output =' 'adapt = { "interfase" }, output ='
bad_edit only 'only.lua:9: adapt\[1\].only = "grain": "both", "grains" or' \
  'output =' 'adapt = { { "interface", only = "grain" } }, output ='
bad_case only_gas 'only_gas.lua:4: adapt\[1\]: only = "gas", but .* no gas' \
  'return { dimension = 2, domain = { size = 1, level = 4 }, gravity = { 0, 0 },
  grains = { density = 1, rheology = { "newtonian", eta = 1 } },
  boundary = { left = "slip", right = "slip", bottom = "slip", top = "outflow" },
  adapt = { { "velocity", threshold = 1, only = "gas" } }, output = { stop = 1 } }'
bad_edit tracer 'tracer.lua:9: tracers.pressure: this name is taken' \
  'output =' 'tracers = { pressure = function() return 1 end }, output ='
for name in viscous_x nu cell_8 vertices; do
  bad_edit "tracer_$name" "tracer_$name.lua:9: tracers.$name: this name is" \
    'output =' "tracers = { $name = function() return 1 end }, output ="
done
long=$(printf 'x%.0s' {1..63})
bad_edit tracer_long 'tracer_long.lua:9: tracers: "yx*" is no name: .*at most 63' \
  'output =' "tracers = { y$long = function() return 1 end }, output ="
bad_edit title_long 'title_long.lua:9: title = .*a text of at most 255' \
  'output =' "title = ('x'):rep(256), output ="
bad_edit many_times 'many_times.lua:9: output.profile_times has 257 elements' \
  'stop = 1' 'stop = 1, profile_times = { ("1,"):rep(257):byte(1, 257) }'
bad_edit many_criteria 'many_criteria.lua:9: adapt has 9 elements, at most 8' \
  'output =' 'adapt = { ("1"):rep(9):byte(1, 9) }, output ='
for value in size=1e308 size=1e-320 density=1e60 pressure=-1e300; do
  bad_edit "size_of_$value" 'from 1e-50 to 1e\+50, by size, is needed' \
    "${value%%=*} = $(grep -oP "(?<=${value%%=*} = )[0-9]" <<< "$good" |
      head -n 1)" "${value%%=*} = ${value#*=}"
done
bad_edit origin 'origin.lua:2: domain: cells of 0.125 cannot be told apart at' \
  'size = 4' 'size = 4, origin = { 1e20, 0 }'
bad_edit gas_missing 'gas_missing.lua:5: gas is missing: .*leaves a part' \
  'gas = {' 'tracers = nil and {'
all=${good/gas = /tracers = nil and }
bad_case gas_all_over 'gas_all_over.lua:5: gas is missing: .*is positive wherev' \
  "${all/return math.min(1 - x, 1 - y)/return 1}"
bad_edit dimension 'dimension.lua:1: dimension = 4: .*from 2 to 3' \
  'dimension = 2' 'dimension = 4'

# Lua
bad_edit syntax "syntax.lua:2: '=' expected|syntax.lua:2: .*expected" \
  'size = 4' 'size 4'
bad_edit runtime "runtime.lua:2: attempt to (perform arithmetic|call)" \
  'size = 4' 'size = ("x")()'
bad_edit undefined "undefined.lua:2: 'sise' is not defined" 'size = 4' \
  'size = sise'
bad_edit function_fails 'function_fails.lua:5: .*grains.shape\(.*fails' \
  '1 - y)' '1 - y.z)'
bad_edit function_nil 'function_nil.lua:5: grains.shape\(.*returned nil' \
  'return math.min(1 - x, 1 - y)' ''
bad_edit function_inf \
  'function_inf.lua:5: grains.shape\(0, 0\) returned -inf, a finite number' \
  'return math.min(1 - x, 1 - y)' 'return -1 / 0'
bad_edit function_text 'function_text.lua:5: grains.shape\(0, 0\) returned string' \
  'return math.min(1 - x, 1 - y)' 'return "1"'
bad_edit velocity_huge \
  'velocity_huge.lua:9: velocity\(0, 0\) returned 1e\+60, a number of size <=' \
  'output =' 'velocity = function() return 0, 1e60 end, output ='
# a fault at some point only, which only the run comes to, as the surface is curved
bad_edit function_point \
  'function_point.lua:5: grains.shape\(0.515625, .*\) returned nil' \
  'return math.min' \
  'if x > 0.51 and x < 0.53 then return end return 0.2 * x * y + math.min'
bad_edit function_endless 'function_endless.lua:5: .*still running' \
  'return math.min' 'while true do end return math.min'
bad_case endless 'endless.lua:1: .*still running' 'while true do end'
bad_case memory 'memory.lua: .*memory' \
  'local t = {} for i = 1, 1e9 do t[i] = i end'
bad_case nothing 'nothing.lua returns nothing, a case must end in' 'local a = 1'
bad_case number 'number.lua returns number, a case must end in' 'return 1'
bad_case execute "execute.lua:1: 'os' is not available" \
  'os.execute("touch written")'
bad_case open "open.lua:1: 'io' is not available" 'io.open("written", "w")'
bad_case require_os "require_os.lua:1: 'require' is not available" \
  'require("os")'
bad_case declared_twice 'declared_twice.lua:2: .*declared before' \
  'param("a", 1, "")
param("a", 1, "")'

refuses check 'level_40.lua:2: domain.level = 40' check ../cases/level_40.lua

bad_edit pattern 'pattern.lua:9: .*still running after 100 .* in .find' \
  'stop = 1' 'stop = ("a"):rep(99):find(("a-"):rep(30) .. "b")'
bad_edit random 'random.lua:5: grains.shape.*it must depend on its arguments' \
  'return math.min' 'return math.random() + math.min'

# the command line
echo "local n = param('level', 5, 'finest level')
param('times', {1, 2}, 'a list')
param('flag', true, 'a switch')
${good/level = 5/level = n}" > cases/param.lua
refuses unknown_override 'levl=6 .*no parameter .levl.*`level`' \
  run ../cases/param.lua levl=6
refuses override_type 'level=x on the command line: a number is needed' \
  run ../cases/param.lua level=x
refuses override_list 'times=1,x on the command line: a list' \
  run ../cases/param.lua times=1,x
refuses override_flag 'flag=1 on the command line: true or false' \
  run ../cases/param.lua flag=1
refuses override_range 'param.lua:5: domain.level = 40' \
  run ../cases/param.lua level=40
refuses override_finite 'level=1e999 on the command line: a finite' \
  run ../cases/param.lua level=1e999
refuses override_wraps 'level=0x10000000000000005 .*: a finite decimal' \
  run ../cases/param.lua level=0x10000000000000005
refuses override_twice 'level=5 and level=6 on the command line: give one' \
  run ../cases/param.lua level=5 level=6
refuses override_first 'cannot read the case level=5: .*the case comes first' \
  run level=5
refuses key_twice 'd=1 and d=2 on the command line: give one' \
  rheology mu_i d=1 d=2
refuses directory_missing '-o needs a value: -o DIR' \
  run ../cases/good.lua -o --restart
refuses directory_option '-o -x: a directory is needed; .* say ./-x' \
  run ../cases/good.lua -o -x
refuses directory_twice '-o a and -o b: give one of them' \
  run ../cases/good.lua -o a -o b
refuses missing_file 'none.lua: No such file' run ../cases/none.lua
refuses directory_as_case 'cases: Is a directory' run ../cases
refuses unknown_command 'unknown command rum; did you mean run' rum
refuses unknown_option 'unknown option --restrat; did you mean --restart' \
  run ../cases/good.lua --restrat
refuses no_likeness 'unknown command walk; `talus help`' walk
refuses unknown_topic 'no help on outptu; did you mean output' help outptu
TALUS_PYTHON=$directory/none refuses no_python 'TALUS_PYTHON=.*no such program' \
  plot ../cases
refuses option_value '--max-steps x: a number of steps' \
  run ../cases/good.lua --max-steps x
refuses no_case 'which case' run
refuses unwritable "output directory '../cases/good.lua/out'" \
  run ../cases/good.lua -o ../cases/good.lua/out
refuses unwritable_proc "output directory '/proc/talus'" \
  run ../cases/good.lua -o /proc/talus

# A path with = in it is a path
mkdir cases/a=1
cp cases/good.lua cases/a=1/b=2.lua
(cd work && "$build/talus" check ../cases/a=1/b=2.lua) > output 2>&1 ||
  complain "a path with = in it is refused"

# Help where it is looked for
shows() {
  local pattern=$1
  shift
  "$build/talus" "$@" > output 2>&1 || complain "$*: exit status $?"
  grep -qE "$pattern" output || complain "$*: nothing matches $pattern"
}
shows '^talus run CASE.lua' run --help
shows '^talus run CASE.lua' run cases/good.lua -h
for page in run check info plot; do
  shows "^talus $page " help $page
done
shows '^  fraction ' help output
# every column of series.csv is in the page, and grains are missed
none=${good/return math.min(1 - x, 1 - y)/return -1}
echo "${none/stop = 1/stop = 0.01}" > cases/no_grains.lua
shows 'warning: grains.shape is positive nowhere that was tried' \
  check cases/no_grains.lua
shows 'warning: grains.shape is positive nowhere: there are no' \
  run cases/no_grains.lua -o no_grains
shows '^  fraction +1 +volume fraction' info no_grains/snapshot-000000.h5
"$build/talus" help output > page
for column in $(head -n 1 no_grains/series.csv | tr , ' '); do
  grep -qE "^  (.*, )?$column(,| |\$)" page ||
    complain "\`talus help output\` has no $column"
done

# Outlines to compare with that are not there
echo "param('reference', '', 'outlines')
$good" > cases/reference.lua
touch cases/there.csv
shows 'warning: reference=none.csv: there is no such file' \
  check cases/reference.lua reference=none.csv
"$build/talus" check cases/reference.lua reference=there.csv > output 2>&1
grep -q warning output && complain "a reference beside the case is not seen"

# A run that is replaced
shows '^no_grains held a run to time 0.01; it is replaced$' \
  run cases/no_grains.lua -o no_grains

[ "$failures" -eq 0 ]
