#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs of model = "two_fluid": restart bit for bit, the same on two ranks, wrong
# cases refused. Usage: two_fluid.sh BUILD
. "$(dirname "$0")/common.bash"
talus=$build/talus

# agrees CASE RANKS WHAT: RANKS have the front of the run CASE, but for what the
# solvers' tolerance lets through
agrees() {
  ends 0 mpirun --oversubscribe -n "$2" "$build/talus2d" run "$1.lua" \
    -o "$1_ranks" --quiet
  awk -v a="$(last "$1" front)" -v b="$(last "$1_ranks" front)" \
    'BEGIN { d = a - b; exit !(d < 1e-5 && d > -1e-5) }' ||
    complain "$2 ranks have another front $3"
}

cat > cliff.lua << 'END'
local phi = param("phi", 0.6, "solid fraction")
return {
  model = "two_fluid", dimension = 2,
  domain = { size = 0.4, level = 5, level_min = 3 },
  gravity = { 0, -9.81 },
  grains = { density = param("density", 2560, "kg/m^3"), d = 1e-3,
             alpha_start = phi, start = param("start", "settled", "start"),
             eta_max = param("eta_max", 0, "Pa s"),
             shape = function(x, y) return math.min(0.1 - x, 0.1 - y) end },
  fluid = param("fluid", "water", "fluid"), closure = "ktgf",
  boundary = { left = "slip", right = "no_slip", bottom = "no_slip",
               top = "slip" },
  adapt = { { "interface", width = 2 }, { "inside" } },
  output = { stop = param("stop", 0.1, "s") },
}
END
restarts cliff 9 cliff.lua
agrees cliff 2 "of a cliff"

# a tolerance below round-off asks for no more than that
sed 's/  output = /  solver = { tolerance = 1e-16 },\n&/' cliff.lua > exactly.lua
ends 5 "$talus" run exactly.lua -o exactly --quiet --max-steps 3
# another gravity on restart is a change of energy, and no burst
cp -r cliff turned
sed 's/-9.81/-19.62/' cliff.lua > heavy.lua
ends 5 "$talus" run heavy.lua stop=0.2 -o turned --quiet --restart --max-steps 1
grep -q burst output && complain "another gravity is taken for a burst"
books cliff turned lost
# no grains are told of
sed 's/shape = .*/shape = function(x, y) return -1 end },/' cliff.lua > none.lua
ends 0 "$talus" run none.lua stop=0.01 -o none --quiet
says 'there are no grains'

ends 2 "$talus" run cliff.lua phi=0.7 start=patched -o wrong
says 'densest packing of these closures is 0.63'
ends 2 "$talus" run cliff.lua density=900 -o wrong
says 'as dense as the grains or denser'
ends 2 "$talus" check cliff.lua eta_max=-1
says 'eta_max'
ends 2 "$talus" check cliff.lua fluid=oil
says '"air", "water", "pac2", "pac4"'
sed 's/fluid = param.*closure/fluid = { eta_0 = 1 }, closure/' cliff.lua > own.lua
ends 2 "$talus" run own.lua -o wrong
says 'fluid.density is missing'
sed 's/fluid = param.*closure/fluid = { "water", eta_0 = -1 }, closure/' \
  cliff.lua > own.lua
ends 2 "$talus" check own.lua
says 'fluid.eta_0'
sed 's/top = "slip"/top = { "inflow", velocity = { 0, -1 }, fraction = 0.5 }/' \
  cliff.lua > in.lua
ends 2 "$talus" run in.lua -o wrong
says 'only fluid passes the sides'
sed 's/bottom = "no_slip"/bottom = { "inflow", velocity = { 0, 0.01 } }/' \
  cliff.lua > closed.lua
ends 2 "$talus" run closed.lua -o wrong
says 'let in 0.004 m^2/s.*outflow'
sed 's/d = 1e-3/d = 1e-3, rho_d = 2/' cliff.lua > key.lua
ends 2 "$talus" check key.lua
says 'rho_d'

# grains of mu(I) and phi(I) hold a settled start
ends 0 "$talus" run "$root/examples/cliff.lua" closure=mu_i_phi_i cells=8 \
  stop=0.2 -o gas --quiet
grep -q burst output && complain "grains of mu_i_phi_i burst"
ends 0 "$talus" run "$root/examples/cliff.lua" closure=mu_i_phi_i fluid=water \
  d=0.01 x_0=1 stop=1.2 -o stones --quiet
grep -q burst output && complain "stones of mu_i_phi_i burst in water"

# those of rauter cannot give way where their weight packs them beyond phi_m
for command in check run; do
  ends 2 "$talus" $command "$root/examples/cliff.lua" closure=rauter
  says 'its foot to a solid fraction of 0.62.*phi_m = 0.585.*allows 0.0112 m'
done
ends 0 "$talus" run "$root/examples/cliff.lua" closure=rauter x_0=0.011 \
  cells=8 stop=0.1 -o low --quiet
grep -q burst output && complain "low grains of rauter burst"

# a run that makes energy is not passed over
ends 0 "$talus" run cliff.lua start=patched phi=0.62 stop=0.1 -o dense --quiet
says 'J more than at the start.*they have burst'
for dense in 0 1; do
  ends 0 "$talus" run "$root/examples/submarine.lua" dense=$dense level=3 \
    stop=0.2 -o calm$dense --quiet
  grep -q burst output && complain "a run that makes no energy is warned of"
done

# tracers: what a profile has of them stays, over a restart too
sed 's/domain = /tracers = { low = function(x, y) return 0.05 - y end }, &/' \
  cliff.lua > tracer.lua
restarts tracer 9 tracer.lua
awk -F, 'NR > 1 { h[$1] += $3; low[$1] += $4 }
         END { for (t in h) if (low[t] / h[t] < 0.5 || low[t] / h[t] > 0.52)
                 exit 1 }' tracer/profile.csv || complain "tracers get lost"

# rings: restart and ranks
sed 's/dimension = /coordinates = "axisymmetric", &/' cliff.lua > ring.lua
restarts ring 9 ring.lua
agrees ring 3 "in rings"

# without the surface in closures and fluxes: restart and ranks
sed 's/alpha_start = phi,/&  surface = "none",/' cliff.lua > weak.lua
restarts weak 9 weak.lua
agrees weak 2 "without planes"

# with friction capped: the same; an exact yield bounds no viscosity
sed 's/alpha_start = phi,/&  regularisation = "clip",/' cliff.lua > clip.lua
restarts clip 9 clip.lua
agrees clip 2 "with friction capped"
ends 0 "$talus" check clip.lua eta_max=1e5
ends 2 "$talus" check cliff.lua eta_max=1e5
says 'grains.eta_max = 100000 has no meaning'

[ "$failures" -eq 0 ]
