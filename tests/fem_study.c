/* fem_study FORM CUT CELLS: Cook's membrane, nearly incompressible, at rest; for
 * validate/fem_study.py. Prints the deflection of the corner, the checkerboard part of the
 * pressure, steps and the time step, then a row per node of the grid: x, y, pressure. */
#include "cook.h"

int main(int count, char **argument) {
    if (count != 4) {
        fprintf(stderr, "usage: fem_study displacement|mixed chess|rising|falling CELLS\n");
        return 2;
    }
    const cook c = {.form = strcmp(argument[1], "mixed") ? GN_FEM_DISPLACEMENT : GN_FEM_PRESSURE,
                    .cut = *argument[2] == 'c'   ? COOK_CHESS
                           : *argument[2] == 'r' ? COOK_RISING
                                                 : COOK_FALLING,
                    .poisson = 0.4999,
                    .cells = atoi(argument[3])};
    gn_fem_solid *solid = cook_at_rest(&c);
    double *p = cook_pressure(solid);
    printf("%.8g %.6g %lld %.6g\n", cook_deflection(solid, &c), cook_checkerboard(p, c.cells),
           (long long)solid->step, solid->dt_past);
    for (int row = 0; row <= c.cells; row++)
        for (int column = 0; column <= c.cells; column++) {
            const double *x = solid->nodes.start + 4 * cook_node(solid, c.cells, column, row);
            printf("%.8g %.8g %.8g\n", x[0], x[1], p[row * (c.cells + 1) + column]);
        }
    free(p);
    body_end(solid);
    return 0;
}
