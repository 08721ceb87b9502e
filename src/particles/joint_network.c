/* Networks of joints: drawn at random, or read from a file. */
#include "particles/joint_faces.h"

#include "base/new.h"
#include "base/random.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "io/io.h"
#include "particles/particles.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- drawn --- */

typedef struct draws {
    uint64_t seed, next;
} draws;

/* Returns a number in (0, 1). */
static double draw(draws *of) {
    return ((double)(gn_random_bits(of->seed, of->next++) >> 11) + 0.5) * 0x1p-53;
}

/* Draws a normal by the distribution of Fisher (1953): the angle to the mean has the density
 * kappa sin(a) exp(kappa cos(a))/(2 sinh(kappa)). Its inverse distribution is
 * cos(a) = 1 + ln(u + (1 - u) exp(-2 kappa))/kappa. */
static void draw_normal(draws *of, const double mean[3], double kappa, double normal[3]) {
    double side[3] = {0}, across[3], up[3];
    const double u = draw(of), turn = 2.0 * M_PI * draw(of);
    double cosine =
        kappa > 0.0 ? 1.0 + log(u + (1.0 - u) * exp(-2.0 * kappa)) / kappa : 2.0 * u - 1.0;
    if (isinf(kappa)) cosine = 1.0;
    cosine = fmax(-1.0, fmin(1.0, cosine));
    side[fabs(mean[0]) < 0.5 ? 0 : 1] = 1.0;
    gn_cross3(mean, side, across);
    const double size = sqrt(gn_dot3(across, across)), sine = sqrt(1.0 - cosine * cosine);
    for (int a = 0; a < 3; a++) across[a] /= size;
    gn_cross3(mean, across, up);
    for (int a = 0; a < 3; a++)
        normal[a] = cosine * mean[a] + sine * (cos(turn) * across[a] + sin(turn) * up[a]);
}

/* Draws a normal in the plane: twice its angle to the mean has von Mises' distribution, by
 * rejection. */
static void draw_line(draws *of, const double mean[3], double kappa, double normal[3]) {
    double angle = 0.0;
    bool taken = isinf(kappa);
    while (!taken) {
        angle = M_PI * (draw(of) - 0.5);
        taken = draw(of) <= exp(kappa * (cos(2.0 * angle) - 1.0));
    }
    normal[0] = cos(angle) * mean[0] - sin(angle) * mean[1];
    normal[1] = sin(angle) * mean[0] + cos(angle) * mean[1];
    normal[2] = 0.0;
}

/* Draws a radius r with N(> r) ~ r^-D between two bounds. */
static double draw_radius(draws *of, const gn_joint_def *def) {
    const double low = def->radius, high = def->network.radius_max, d = def->network.exponent;
    if (!(high > low)) return low;
    const double u = draw(of);
    if (d == 0.0) return low * pow(high / low, u);
    return low * pow(1.0 - u * (1.0 - pow(low / high, d)), -1.0 / d);
}

/* Centres are uniform in the box of the specimen, extended by the largest radius, so that joints
 * near its sides are as many as inside. Joints are added until their area in the specimen is
 * nearest to the intensity. */
gneiss_status gn_joint_network_draw(const gn_step_context *ctx, const gn_dem *dem, int32_t joint,
                                    gn_joint_faces *faces, gneiss_error *error) {
    enum { MOST = 1000000 };
    const gn_joint_def *def = &ctx->scene.joints[joint];
    const int dimension = (int)ctx->scene.dimension;
    const double wanted = def->network.intensity * ctx->volume,
                 reach = fmax(def->radius, def->network.radius_max);
    GN_FREED gn_outline *outline = NULL;
    GN_TRY(gn_new(&outline, 1, "the outline of the specimen", error));
    gn_outline_find(&ctx->scene, &dem->particles, outline);
    draws of = {ctx->scene.seed ^ (UINT64_C(0x6a6f696e74) + ((uint64_t)joint << 40)), 0};
    double sum = 0.0;
    for (size_t drawn = 0; sum < wanted; drawn++) {
        double point[3] = {0}, normal[3], area;
        for (int a = 0; a < dimension; a++)
            point[a] =
                ctx->lower[a] - reach + draw(&of) * (ctx->upper[a] - ctx->lower[a] + 2.0 * reach);
        if (dimension == 3)
            draw_normal(&of, def->normal, def->network.fisher, normal);
        else
            draw_line(&of, def->normal, def->network.fisher, normal);
        gn_joint_face *f = gn_joint_faces_add(faces, point, normal, dimension);
        if (!f) return gn_no_memory(error, "joints");
        f->joint = joint;
        f->radius = draw_radius(&of, def);
        GN_TRY(gn_joint_face_area(faces, f, outline, &area, error));
        const bool spare = sum + area - wanted > wanted - sum;
        if (spare || !(area > 0.0)) faces->count--;
        if (spare) break;
        sum += area;
        if (drawn == MOST)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: expected an intensity that at most %d joints have, found more",
                           gn_scene_at(&ctx->scene, def->where, "joints").text, (int)MOST);
    }
    return GNEISS_OK;
}

/* --- from a file --- */

/* The numbers of a row: x y z dip direction radius, in 2D x y dip half-length. */
enum { NUMBERS_MOST = 6 };

static gneiss_status add_disc(const gn_scene *scene, int32_t joint, const double *row,
                              gn_joint_faces *faces, gneiss_error *error) {
    const double degree = M_PI / 180.0;
    const bool space = scene->dimension == 3;
    const double dip = degree * row[space ? 3 : 2], along = space ? degree * row[4] : 0.0;
    double point[3] = {row[0], row[1], space ? row[2] : 0.0};
    const double in_space[3] = {sin(dip) * sin(along), sin(dip) * cos(along), cos(dip)};
    const double in_plane[3] = {sin(dip), cos(dip), 0.0};
    for (int a = 0; a < (int)scene->dimension; a++) point[a] -= scene->origin[a];
    gn_joint_face *f =
        gn_joint_faces_add(faces, point, space ? in_space : in_plane, (int)scene->dimension);
    if (!f) return gn_no_memory(error, "joints");
    f->joint = joint;
    f->radius = row[space ? 5 : 3];
    return GNEISS_OK;
}

/* Reads the numbers of a line, which commas or white space separate. Returns the column of the
 * first character that is none of these, from 1; 0: the line has them all and no more. */
static size_t read_numbers(const char *line, size_t count, double *row) {
    const char *at = line;
    for (size_t k = 0; k < count; k++) {
        char *end;
        row[k] = strtod(at, &end);
        if (end == at || !isfinite(row[k])) return (size_t)(at - line) + 1;
        at = end + strspn(end, " \t");
        if (k + 1 < count && *at == ',') at += 1 + strspn(at + 1, " \t");
    }
    at += strspn(at, " \t\r");
    return *at ? (size_t)(at - line) + 1 : 0;
}

gneiss_status gn_joint_discs_read(const gn_scene *scene, int32_t joint, gn_joint_faces *faces,
                                  gneiss_error *error) {
    const char *path = scene->joints[joint].discs_path;
    const size_t count = scene->dimension == 3 ? 6 : 4, limit = (size_t)1 << 30;
    char *text, *rest = NULL;
    size_t number = 0;
    GN_TRY(gn_read_text_file(path, limit, &text, error));
    gneiss_status status = GNEISS_OK;
    for (char *line = text; status == GNEISS_OK && line; line = rest) {
        double row[NUMBERS_MOST];
        rest = strchr(line, '\n');
        if (rest) *rest++ = '\0';
        number++;
        const char *first = line + strspn(line, " \t\r");
        if (!*first || *first == '#' || (number == 1 && isalpha((unsigned char)*first))) continue;
        const size_t wrong = read_numbers(line, count, row);
        if (wrong || !(row[count - 1] > 0.0))
            status = gn_fail(error, GNEISS_ERROR_INPUT,
                             "%s:%zu:%zu: expected %zu numbers (%s), the last above 0, found '%s'",
                             path, number, wrong ? wrong : 1, count,
                             count == 6 ? "x, y, z, dip, dip direction, radius; m and degrees"
                                        : "x, y, dip, half-length; m and degrees",
                             line);
        else
            status = add_disc(scene, joint, row, faces, error);
    }
    free(text);
    return status;
}
