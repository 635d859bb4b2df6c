"""Claims about shear, Figs. 3 and 4 of the paper: a cell between serrated plates."""
