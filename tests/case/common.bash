# SPDX-License-Identifier: GPL-3.0-or-later
# For the scripts of tests/case. Containers run as root and forbid CMA.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_btl_vader_single_copy_mechanism=none

# own_words < FILE: what is left without what MPI and the libraries below it
# print by themselves: boxes between dashes, lines of [host:process], words on
# displays and devices that are not there
own_words() {
  awk '/^--------------------+$/ { box = !box; next }
    box || /^ *$/ || /^\[[^]]*[:,][0-9]+\]/ { next }
    /^(No protocol specified|Authorization required|Invalid MIT-MAGIC)/ { next }
    /^(libibverbs|librdmacm|libfabric|hwloc|PMIX|PSM|UCX|mlx[0-9]*)[:/ ]/ { next }
    { print }'
}
