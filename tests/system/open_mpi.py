"""The environment in which tests start Open MPI: version 4 of Debian 12, or version 5 of Debian 13, which reads
PRTE_MCA_….

Jobs run as root, without a network, with more processes than processors, and without a processor of its own for each of
them. hwloc must not look for screens: a process ends when the Xvfb of another test ends while it looks.
"""

OPEN_MPI = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_btl": "self,vader",
    "OMPI_MCA_plm": "isolated",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "PRTE_MCA_hwloc_default_binding_policy": "none",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "HWLOC_COMPONENTS": "-gl",
    "OMPI_MCA_mpi_yield_when_idle": "1",
}
