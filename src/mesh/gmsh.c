#include "mesh/gmsh.h"

#include "io/atomic_file.h"
#include "io/io.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

bool gn_is_geometry(const char *path) {
    static const char *const ends[] = {".geo", ".step", ".stp", ".brep", ".iges", ".igs"};
    const char *dot = strrchr(path, '.');
    for (size_t k = 0; dot && k < sizeof ends / sizeof *ends; k++)
        if (strcasecmp(dot, ends[k]) == 0) return true;
    return false;
}

/* Copies the last line of a log that is not blank; "" if there is none. */
static void last_line(const char *log, char *line, size_t size) {
    char text[512];
    *line = '\0';
    FILE *file = fopen(log, "re");
    if (!file) return;
    while (fgets(text, sizeof text, file)) {
        text[strcspn(text, "\r\n")] = '\0';
        if (text[strspn(text, " \t")]) snprintf(line, size, "%.*s", (int)size - 1, text);
    }
    fclose(file);
}

static int spawn(char *const arguments[], const char *log, pid_t *child) {
    posix_spawn_file_actions_t actions;
    int code = posix_spawn_file_actions_init(&actions);
    if (code) return code;
    code = posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log,
                                            O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (!code) code = posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    if (!code) code = posix_spawnp(child, arguments[0], &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    return code;
}

/* A script that is merged after the geometry, so that elements are linear for any geometry. The
 * geometry would override an option of the command line, because it is read later. */
static const char linear[] = "Mesh.ElementOrder = 1;\n";

enum { ARGUMENTS = 10 };

/* posix_spawnp does not modify the strings, but does not declare them const. */
static void arguments_of(const char *path, int dimension, const char *out, const char *order,
                         char *arguments[ARGUMENTS]) {
    char *const all[ARGUMENTS] = {"gmsh",        dimension == 3 ? "-3" : "-2",
                                  "-format",     "msh41",
                                  "-o",          (char *)out,
                                  "-nopopup",    (char *)path,
                                  (char *)order, NULL};
    memcpy(arguments, all, sizeof all);
}

void gn_mesh_geometry_command(const char *path, int dimension, char *text, size_t size) {
    char *arguments[ARGUMENTS];
    size_t used = 0;
    arguments_of(path, dimension, "FILE", "LINEAR.geo", arguments);
    *text = '\0';
    for (size_t k = 0; arguments[k] && used < size; k++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", k ? " " : "", arguments[k]);
}

static gneiss_status run_gmsh(const char *path, int dimension, const char *out, const char *order,
                              const char *log, gneiss_error *error) {
    char *arguments[ARGUMENTS];
    arguments_of(path, dimension, out, order, arguments);
    pid_t child;
    int code = spawn(arguments, log, &child), state;
    if (code == ENOENT)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: gmsh has to mesh it, but is not installed (Debian package gmsh); or "
                       "give a .msh file",
                       path);
    if (code)
        return gn_fail(error, GNEISS_ERROR_IO, "gmsh could not be started: %s", strerror(code));
    while (waitpid(child, &state, 0) < 0)
        if (errno != EINTR)
            return gn_fail(error, GNEISS_ERROR_IO, "waiting for gmsh to end failed: %s",
                           strerror(errno));
    if (WIFEXITED(state) && WEXITSTATUS(state) == 0 && access(out, R_OK) == 0) return GNEISS_OK;
    char said[300];
    last_line(log, said, sizeof said);
    return gn_fail(error, GNEISS_ERROR_INPUT, "%s: gmsh made no mesh of it: %s", path,
                   *said ? said : "it gave no reason");
}

/* Reads the mesh. Messages about it name the geometry, because the mesh is deleted before they are
 * read. */
static gneiss_status read_made(const char *path, const char *out, double scale, gn_mesh *mesh,
                               gneiss_error *error) {
    char text[GNEISS_MESSAGE_SIZE];
    const size_t length = strlen(out);
    gneiss_status status = gn_mesh_read_msh(out, scale, mesh, error);
    if (status == GNEISS_OK || !error || strncmp(error->message, out, length) != 0) return status;
    memcpy(text, error->message, sizeof text);
    return gn_fail(error, status, "%.600s: in the mesh that gmsh made of it%.1300s", path,
                   text + length);
}

static gneiss_status mesh_in(const char *folder, const char *path, int dimension, double scale,
                             gn_mesh *mesh, gneiss_error *error) {
    char *out = gn_text_format("%s/mesh.msh", folder), *log = gn_text_format("%s/log.txt", folder),
         *order = gn_text_format("%s/order.geo", folder);
    gneiss_status status = GNEISS_OK;
    if (!out || !log || !order) status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to mesh");
    if (status == GNEISS_OK) status = gn_write_text_file(order, linear, GN_RENAMED, error);
    if (status == GNEISS_OK) status = run_gmsh(path, dimension, out, order, log, error);
    if (status == GNEISS_OK) status = read_made(path, out, scale, mesh, error);
    if (out) unlink(out);
    if (log) unlink(log);
    if (order) unlink(order);
    free(out);
    free(log);
    free(order);
    return status;
}

gneiss_status gn_mesh_geometry(const char *path, int dimension, double scale, gn_mesh *mesh,
                               gneiss_error *error) {
    *mesh = (gn_mesh){0};
    const char *place = getenv("TMPDIR");
    char *folder = gn_text_format("%s/gneiss-mesh-XXXXXX", place && *place ? place : "/tmp");
    gneiss_status status = GNEISS_OK;
    if (!folder || !mkdtemp(folder)) {
        status =
            gn_fail(error, GNEISS_ERROR_IO, "no temporary folder for gmsh: %s", strerror(errno));
    } else {
        status = mesh_in(folder, path, dimension, scale, mesh, error);
        rmdir(folder);
    }
    free(folder);
    return status;
}
