/* Geometries that another program meshes. Here a script called gmsh, first in PATH, replaces it, so
 * that the test does not depend on the real program. */
#include "io_helpers.h"

#include "mesh/gmsh.h"

#include <sys/stat.h>

static const char square[] = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
                             "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n"
                             "$Elements\n2\n1 2 2 0 1 1 2 3\n2 2 2 0 1 1 3 4\n$EndElements\n";

static void put(const char *dir, const char *name, const char *text, mode_t mode) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    assert_int_equal(chmod(path, mode), 0);
}

/* Writes a script gmsh that does `body`; $5 is the wanted file as in `gmsh -2 -format msh41 -o
 * FILE`. */
static void fake(const char *dir, const char *body) {
    char script[2048], path[4096];
    snprintf(script, sizeof script, "#!/bin/sh\n%s\n", body);
    put(dir, "gmsh", script, 0755);
    snprintf(path, sizeof path, "%s:/usr/bin:/bin", dir);
    setenv("PATH", path, 1);
    setenv("TMPDIR", dir, 1);
}

static int set_up(void **state) {
    return make_fixture(state, "body.geo");
}

static void geometries_are_known_by_their_ends(void **state) {
    (void)state;
    assert_true(gn_is_geometry("a/b.geo"));
    assert_true(gn_is_geometry("b.STEP"));
    assert_false(gn_is_geometry("b.msh"));
    assert_false(gn_is_geometry("geo"));
}

static void the_mesh_that_gmsh_makes_is_read(void **state) {
    fixture *f = *state;
    char body[1024];
    gneiss_error error = {0};
    gn_mesh mesh;
    put(f->dir, "square.msh", square, 0644);
    put(f->dir, "body.geo", "// a square", 0644);
    snprintf(body, sizeof body, "test \"$1\" = -2 && cp %s/square.msh \"$5\"", f->dir);
    fake(f->dir, body);
    assert_int_equal(gn_mesh_geometry(f->path, 2, 0.5, &mesh, &error), GNEISS_OK);
    assert_int_equal(mesh.triangles.count, 2);
    assert_float_equal(mesh.node[3 * 2], 0.5, 0.0);
    gn_mesh_free(&mesh);
    assert_int_equal(entries(f->dir, false),
                     3); /* the folder has square.msh, body.geo and gmsh: no other file is left */
}

static void what_gmsh_says_last_is_the_message(void **state) {
    fixture *f = *state;
    gneiss_error error = {0};
    gn_mesh mesh;
    put(f->dir, "body.geo", "nonsense", 0644);
    fake(f->dir, "echo Info: reading; echo 'Error: unknown command'; echo; exit 1");
    assert_int_equal(gn_mesh_geometry(f->path, 3, 1.0, &mesh, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "body.geo: gmsh made no mesh of it: Error: unknown"));
    assert_int_equal(entries(f->dir, false), 2);
}

static void a_missing_gmsh_is_reported(void **state) {
    fixture *f = *state;
    gneiss_error error = {0};
    gn_mesh mesh;
    put(f->dir, "body.geo", "// nothing", 0644);
    setenv("TMPDIR", f->dir, 1);
    setenv("PATH", f->dir, 1);
    assert_int_equal(gn_mesh_geometry(f->path, 3, 1.0, &mesh, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "is not installed"));
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, set_up, teardown)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(geometries_are_known_by_their_ends),
        WITH(the_mesh_that_gmsh_makes_is_read),
        WITH(what_gmsh_says_last_is_the_message),
        WITH(a_missing_gmsh_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
