/* Columns that exist in test_more_columns.c only, as a future law might add them to contacts. The
 * build includes this file before all others in that test and in every source that stores contacts
 * by value. */
#ifndef GN_TESTS_MORE_COLUMNS_H
#define GN_TESTS_MORE_COLUMNS_H

#define GN_MORE_CONTACT_COLUMNS(Y, X)                                                              \
    Y(X, worn, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, INSTEAD, 0, 0, "1",               \
      "even state, in the precision of the contacts")                                              \
    Y(X, lean, double, GN_F64, 2, GN_COLUMNS, GN_STATE, GN_KEPT | GN_ODD, INSTEAD, 0, 0, "1",      \
      "odd state, in the precision of the contacts")                                               \
    Y(X, hard, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, 0, 0, "1",                \
      "a parameter of the pair")                                                                   \
    Y(X, mark, uint8_t, GN_U8, 1, GN_COLUMNS, GN_STATE, GN_KEPT, NONE, 0, 0, "1", "a number")      \
    Y(X, fresh, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, 0, NONE, 0, 0, "1", "not kept")
#define GN_MORE_WALL_CONTACT_COLUMNS(Y, X)                                                         \
    Y(X, worn, double, GN_F64, 2, GN_COLUMNS, GN_STATE, GN_KEPT, NONE, 0, 0, "1", "state")

#endif
