"""Python runs this at its start where this folder is on its path: the process then has a stand-in for a GPU."""

import cuda_stand_in

cuda_stand_in.install()
