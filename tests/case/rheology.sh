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
