#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What `talus rheology` prints. Usage: rheology.sh BUILD
. "$(dirname "$0")/common.bash"
talus=$build/talus

# says PATTERN ARGUMENTS...: a line of the output matches
says() {
  local pattern=$1
  shift
  "$talus" rheology "$@" 2>&1 | grep -qE "$pattern" ||
    complain "talus rheology $*: nothing matches $pattern"
}

# The list has every closure with its keys, and what the keys are for.
says '^lee_huang: '
says '^    lambda +s +0 to 1e\+12 +needed +time'
says '^    e_eff +1 +0.01 to 0.99 +0.58 '

says 'well posed for 0.013631 < I < 1.81' mu_i
says 'well posed for 0 < I < 16.992' mu_i_well_posed
says 'I_tran = 1.171.*mu_tran = 0.542.*I_max = 2.105' lee_huang p=1000
# Fig. 1 of lee_huang_chiew_2015; the paper's table II has I_tran = 1.492.
says 'I_tran = 1.466.*mu_tran = 0.592' four_state e_eff=0.46 eta_S=0.42 d=0.0005
says 'eta_max has no meaning with regularisation=exact' \
  mu_i d=0.001 regularisation=exact eta_max=10
says 'gamma_r has no meaning with regularisation=clip' mu_i d=0.001 gamma_r=2
says 'exact: mu_i_well_posed holds no stress at rest' \
  mu_i_well_posed d=0.001 regularisation=exact
says 'well posed' mu_i d=0.001 regularisation=exact
says 'user: viscosity = .*only a case file' user
says 'lee_huang: nu_min < nu_0 < nu_max' lee_huang nu_0=0.64
says 'closure muI; did you mean mu_i' muI
says 'closure bogus; known: newtonian' bogus
says 'p=0: a pressure > 0' mu_i d=0.001 p=0

# The closures of the two-fluid model, by name and with the numbers of a name.
says 'talus rheology two_fluid' # in the list
says '^critical_state, p = 100 Pa, St = 7.765, r = 1.602' two_fluid
says '^at rest phi = 0.58235,' two_fluid p=1380.6 closure=ktgf fluid=air
says 'St = 0.1078, r = 1.6 ' two_fluid fluid=pac2
says 'closure=ktg: no such closure; did you mean ktgf' two_fluid closure=ktg
says 'angle=3: .* known: .* critical_state.mu_1' two_fluid angle=3
says 'mu_1=99 is out of range: from 0 to 10' two_fluid mu_1=99
says 'fluid is as dense as the grains' two_fluid fluid.density=2560
says 'p=: a number is needed' two_fluid p=
# Plane shear of the kinetic theory at 0.5: tau/p = 0.3051, and p = 11.674 rho_s
# d^2 gamma^2, so that I = 0.29268.
"$talus" rheology two_fluid closure=ktgf --csv | awk -F, '
  $5 == 0.5 { found = $4 > 0.30505 && $4 < 0.30515 && $1 > 0.29266 &&
                      $1 < 0.2927 }
  END { exit !found }' || complain "the curve of ktgf is not that of the table"
# Boyer at J = 1e-2 with a pressure beside which contact is nothing.
"$talus" rheology two_fluid closure=rauter inertial=0 p=1e8 eta_0=0.981 \
  eta_inf=0.981 --csv | awk -F, '
  NR > 1 { phi = 0.585/(1 + sqrt($7)); mu = 0.32 + 0.38/(1 + 0.005/$7)
           both = mu + $7 + 2.5*0.585*sqrt($7)
           if ($7 > 1e-5 && ((d = $5/phi - 1)^2 > 1e-9 ||
                             (e = $8/both - 1)^2 > 1e-9)) bad++
           if ($7 > 1e-5) n++ }
  END { exit !(n > 0 && !bad) }' || complain "the curve of rauter is not Boyer's"

# 100 rows a decade from 1e-4 to I_max, one at the kink, where mu is largest.
"$talus" rheology lee_huang p=1000 --csv | awk -F, '
  NR == 1 && $0 != "I,shear_rate,eta,mu,nu,state" { exit 1 }
  NR == 2 && $1 != 1e-4 { exit 1 }
  NR > 2 && $1 <= last { exit 1 }
  NR > 1 { last = $1; if ($4 > most) { most = $4; at = $1 } }
  END { exit !(NR == 1 + 433 + 2 && at > 1.1714 && at < 1.1716 &&
               last > 2.1058 && last < 2.106 && $6 == 3) }' ||
  complain "the curve of lee_huang is not what it should be"
# Without nu and state the fields are empty.
[ "$("$talus" rheology mu_i --csv | grep -vc ',,$')" -eq 1 ] ||
  complain "the curve of mu_i has a nu or a state"

[ "$failures" -eq 0 ]
