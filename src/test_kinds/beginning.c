#include "test_kinds/beginning.h"

#include <math.h>

static const double risen = 0.05;

static void look(gn_beginning *beginning, const double *strain, const double *stress, size_t row) {
    const bool known = strain && !isnan(strain[row]) && !isnan(strain[0]);
    if (!beginning->moved && row > 0) beginning->moved = !known || strain[row] > strain[0];
    if (!beginning->moved) {
        beginning->first = beginning->least = row;
        return;
    }
    if (beginning->begun) return;
    const double before = stress[beginning->first];
    if (before > 0.0 && stress[row] < stress[beginning->least]) beginning->least = row;
    beginning->begun = !(before > 0.0) || stress[row] > before ||
                       stress[row] > stress[beginning->least] + risen * before;
}

void gn_beginning_update(gn_beginning *beginning, const double *strain, const double *stress,
                         size_t rows) {
    for (; beginning->rows < rows; beginning->rows++)
        look(beginning, strain, stress, beginning->rows);
}
