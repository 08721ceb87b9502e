#include "sweep/range.h"

#include "base/memory.h"
#include "sweep/sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- values of a key ---- */

static bool is_whole(const gn_key *key) {
    return key->type == GN_KEY_INTEGER || key->type == GN_KEY_SEED || key->type == GN_KEY_CELLS ||
           key->type == GN_KEY_PARTICLES || key->type == GN_KEY_IDS;
}

/* True for a single number; a component of a vector counts as one. */
static bool is_number(const gn_key *key) {
    return is_whole(key) || key->type == GN_KEY_REAL || key->type == GN_KEY_TABLE ||
           key->type == GN_KEY_VECTOR || key->type == GN_KEY_SPIN;
}

static const char *unit_of(const gn_key *key) {
    return is_whole(key) || !key->unit ? "1" : key->unit;
}

/* ---- texts ---- */

void gn_number_text(double value, char *text, size_t size) {
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, size, "%.*g", digits, value);
        if (strtod(text, NULL) == value) return;
    }
}

/* Writes a node as YAML on one line, with quoted scalars inside lists, so that they remain texts.
 */
static void write_flow(FILE *out, const gn_node *node, bool inside) {
    if (node->kind == GN_NODE_NULL) return;
    if (node->kind == GN_NODE_SCALAR) {
        if (inside) fputc('"', out);
        for (const char *c = node->text; *c; c++) {
            bool control = (unsigned char)*c < 0x20 || *c == 0x7f;
            if (inside && (*c == '"' || *c == '\\')) fputc('\\', out);
            if (inside && control)
                fprintf(out, "\\x%02x", (unsigned)(unsigned char)*c);
            else
                fputc(*c, out);
        }
        if (inside) fputc('"', out);
        return;
    }
    fputc(node->kind == GN_NODE_LIST ? '[' : '{', out);
    for (const gn_node *child = node->first; child; child = child->next) {
        if (child->key) fprintf(out, "\"%s\": ", child->key);
        write_flow(out, child, true);
        if (child->next) fputs(", ", out);
    }
    fputc(node->kind == GN_NODE_LIST ? ']' : '}', out);
}

static char *own_text(const char *text) {
    size_t length = strlen(text);
    char *copy = gn_alloc(length + 1);
    if (copy) memcpy(copy, text, length + 1);
    return copy;
}

static char *text_of(const gn_node *node) {
    char *text = NULL, *own = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out) return NULL;
    write_flow(out, node, false);
    if (fclose(out) == 0) own = own_text(text);
    free(text);
    return own;
}

/* ---- values ---- */

static gneiss_status no_memory(const gn_reader *reader) {
    return gn_fail(reader->error, GNEISS_ERROR_MEMORY, "%s: out of memory while reading %s",
                   reader->name, reader->path);
}

static gneiss_status make_values(const gn_reader *reader, size_t count,
                                 gn_sweep_parameter *parameter) {
    parameter->values = gn_alloc_array(count, sizeof *parameter->values);
    parameter->count = parameter->values ? count : 0;
    return parameter->values ? GNEISS_OK : no_memory(reader);
}

/* Adds the value of a node; an invalid value is reported when a scene is read with it. */
static gneiss_status put_node(const gn_reader *reader, const gn_node *node,
                              const gn_sweep_parameter *parameter, gn_sweep_value *value) {
    char reason[96];
    value->where = node->where;
    value->number = NAN;
    if (node->kind == GN_NODE_SCALAR && is_number(parameter->meant) &&
        !gn_read_quantity(reader, node->text, unit_of(parameter->meant), &value->number, reason,
                          sizeof reason))
        value->number = NAN;
    value->text = text_of(node);
    return value->text ? GNEISS_OK : no_memory(reader);
}

static gneiss_status put_number(const gn_reader *reader, double number, gn_scene_place where,
                                gn_sweep_value *value) {
    char text[40];
    gn_number_text(number, text, sizeof text);
    *value = (gn_sweep_value){own_text(text), number, where};
    return value->text ? GNEISS_OK : no_memory(reader);
}

static gneiss_status read_values(const gn_reader *reader, const gn_node *list,
                                 gn_sweep_parameter *parameter) {
    GN_TRY(make_values(reader, list->count, parameter));
    gn_sweep_value *value = parameter->values;
    for (const gn_node *item = list->first; item; item = item->next)
        GN_TRY(put_node(reader, item, parameter, value++));
    return GNEISS_OK;
}

/* ---- ranges ---- */

/* Reports an error at the node; an empty node has no place, so that the key's place is used. */
static gneiss_status wrong(const gn_reader *reader, const gn_node *node, const char *text) {
    return gn_read_fail(reader, node, node->kind == GN_NODE_NULL ? node->key_where : node->where,
                        reader->path, "%s", text);
}

/* Returns value k of a range, whose ends are exactly the given ones. */
static double range_value(const gn_range_def *range, int64_t k) {
    if (k == 0) return range->from;
    if (k == range->count - 1) return range->to;
    double share = (double)k / (double)(range->count - 1);
    if (range->spacing == GN_SPACING_LOG) return range->from * pow(range->to / range->from, share);
    return range->from + (range->to - range->from) * share;
}

static gneiss_status make_range(const gn_reader *reader, const gn_node *node,
                                const gn_range_def *range, gn_sweep_parameter *parameter) {
    if (range->from == range->to)
        return wrong(reader, node, "expected different numbers at start and end");
    GN_TRY(make_values(reader, (size_t)range->count, parameter));
    for (int64_t k = 0; k < range->count; k++) {
        double value = range_value(range, k);
        if (is_whole(parameter->meant)) value = round(value);
        if (k > 0 && value == parameter->values[k - 1].number)
            return gn_read_fail(
                reader, node, node->where, reader->path,
                "expected a range with %lld different whole numbers, found %g twice",
                (long long)range->count, value);
        GN_TRY(put_number(reader, value, node->where, &parameter->values[k]));
    }
    return GNEISS_OK;
}

/* ---- distributions ---- */

static double normal_probability(double z) {
    return 0.5 * erfc(-z * 0.7071067811865476);
}

/* Returns the quantile `uniform` of the distribution. Whole numbers have equal probabilities: each
 * stands for the interval from itself to the next. */
static double draw(const gn_range_def *range, bool normal, bool whole, double uniform) {
    if (normal) {
        double low = normal_probability((range->from - range->mean) / range->deviation),
               high = normal_probability((range->to - range->mean) / range->deviation);
        double value =
            range->mean + range->deviation * gn_normal_quantile(low + (high - low) * uniform);
        value = fmin(fmax(value, range->from), range->to);
        return whole ? round(value) : value;
    }
    if (range->spacing == GN_SPACING_LOG) {
        double value = range->from * pow(range->to / range->from, uniform);
        return whole ? round(value) : value;
    }
    return whole ? fmin(range->from + floor((range->to - range->from + 1.0) * uniform), range->to)
                 : range->from + (range->to - range->from) * uniform;
}

/* Draws one coordinate of all points. */
static gneiss_status draw_points(const gn_reader *reader, const gn_node *node,
                                 const gn_drawing *drawing, double **points) {
    if (drawing->method == GN_SAMPLING_NONE)
        return wrong(reader, node,
                     "expected a count (for a range) or the section sampling (for a distribution), "
                     "found neither");
    if (drawing->method == GN_SAMPLING_SOBOL && drawing->dimension >= GN_SOBOL_DIMENSIONS)
        return gn_read_fail(reader, node, node->where, reader->path,
                            "expected at most %d distributions with sampling.method sobol",
                            GN_SOBOL_DIMENSIONS);
    *points = gn_alloc_array(drawing->count, sizeof **points);
    if (!*points) return no_memory(reader);
    if (drawing->method == GN_SAMPLING_SOBOL)
        gn_sample_sobol(drawing->seed, drawing->dimension, drawing->count, *points);
    else
        gn_sample_latin(drawing->seed, drawing->dimension, drawing->count, *points);
    return GNEISS_OK;
}

static gneiss_status make_draws(const gn_reader *reader, const gn_node *node,
                                const gn_range_def *range, bool normal, const gn_drawing *drawing,
                                gn_sweep_parameter *parameter) {
    double *points = NULL;
    if (!normal && !(range->from < range->to))
        return wrong(reader, node, "expected a distribution from the smaller to the larger value");
    GN_TRY(draw_points(reader, node, drawing, &points));
    gneiss_status status = make_values(reader, drawing->count, parameter);
    for (size_t k = 0; status == GNEISS_OK && k < drawing->count; k++)
        status = put_number(reader, draw(range, normal, is_whole(parameter->meant), points[k]),
                            node->where, &parameter->values[k]);
    gn_free(points);
    parameter->sampled = true;
    return status;
}

/* Draws from a list with equal probabilities. */
static gneiss_status make_choices(const gn_reader *reader, const gn_node *list,
                                  const gn_drawing *drawing, gn_sweep_parameter *parameter) {
    double *points = NULL;
    if (list->kind != GN_NODE_LIST || list->count == 0)
        return wrong(reader, list, "expected a list of values for `of`");
    GN_TRY(draw_points(reader, list, drawing, &points));
    gneiss_status status = make_values(reader, drawing->count, parameter);
    for (size_t k = 0; status == GNEISS_OK && k < drawing->count; k++) {
        size_t place = (size_t)(points[k] * (double)list->count);
        status = put_node(reader, gn_node_item(list, place), parameter, &parameter->values[k]);
    }
    gn_free(points);
    parameter->sampled = true;
    return status;
}

/* ---- a parameter ---- */

/* Reads a range; the table of its keys gets the unit and the interval of the parameter's key. */
static gneiss_status read_range(gn_reader *reader, const gn_node *node, const gn_key *meant,
                                gn_range_def *range) {
    gn_key keys[GN_SECTION_KEYS_MAX];
    gn_section own = gn_range_section;
    memcpy(keys, own.keys, own.key_count * sizeof *keys);
    for (size_t k = 0; k < own.key_count; k++) {
        if (keys[k].type != GN_KEY_REAL) continue;
        bool deviation = keys[k].offset == offsetof(gn_range_def, deviation);
        keys[k].unit = unit_of(meant);
        /* A standard deviation of angles cannot be converted by the tangent. */
        if (deviation && strcmp(keys[k].unit, GN_SLOPE) == 0) keys[k].unit = "1";
        if (!deviation) keys[k].range = meant->range;
    }
    own.keys = keys;
    return gn_read_keys(reader, &own, node, range);
}

static gneiss_status check_range(const gn_reader *reader, const gn_node *node,
                                 const gn_range_def *range, const gn_sweep_parameter *parameter) {
    bool from = gn_node_child(node, "from"), to = gn_node_child(node, "to"),
         normal = gn_node_child(node, "mean") || gn_node_child(node, "deviation");
    if (normal && (!gn_node_child(node, "mean") || !(range->deviation > 0.0)))
        return wrong(reader, node, "expected a mean and a deviation above 0");
    if (normal && (gn_node_child(node, "count") || gn_node_child(node, "spacing")))
        return wrong(reader, node, "expected no count and no spacing with a normal distribution");
    if (normal && !(range->from < range->to))
        return wrong(reader, node, "expected a distribution from the smaller to the larger value");
    if (!normal && (!from || !to))
        return wrong(reader, node,
                     "expected a range {from, to, count}, or a distribution {from, to}, {mean, "
                     "deviation} or {of}");
    if (range->spacing == GN_SPACING_LOG && !(range->from * range->to > 0.0))
        return wrong(reader, node, "expected numbers of one sign, not 0, for logarithmic spacing");
    if (is_whole(parameter->meant) && !normal &&
        (range->from != round(range->from) || range->to != round(range->to)))
        return wrong(reader, node, "expected whole numbers at both ends");
    return GNEISS_OK;
}

static gneiss_status read_map(gn_reader *reader, const gn_node *node, const gn_drawing *drawing,
                              gn_sweep_parameter *parameter) {
    gn_range_def r = {.from = -INFINITY, .to = INFINITY};
    const gn_node *of = gn_node_child(node, "of");
    if (of && node->count > 1) return wrong(reader, node, "expected no key beside `of`");
    if (of) return make_choices(reader, of, drawing, parameter);
    if (!is_number(parameter->meant))
        return wrong(reader, node, "expected a list of values: the key takes no number");
    GN_TRY(read_range(reader, node, parameter->meant, &r));
    if (gn_problem_near(reader->problems, reader->path)) return GNEISS_OK;
    GN_TRY(check_range(reader, node, &r, parameter));
    if (gn_node_child(node, "count")) return make_range(reader, node, &r, parameter);
    return make_draws(reader, node, &r, gn_node_child(node, "mean") != NULL, drawing, parameter);
}

gneiss_status gn_parameter_read(gn_reader *reader, const gn_node *node, const gn_drawing *drawing,
                                gn_sweep_parameter *parameter) {
    if (node->kind == GN_NODE_MAP) {
        GN_TRY(read_map(reader, node, drawing, parameter));
    } else if (node->kind == GN_NODE_LIST && node->count) {
        GN_TRY(read_values(reader, node, parameter));
    } else if (node->kind == GN_NODE_SCALAR) {
        GN_TRY(make_values(reader, 1, parameter));
        GN_TRY(put_node(reader, node, parameter, parameter->values));
    } else {
        return wrong(reader, node,
                     "expected a list of values, a range or a distribution, found nothing");
    }
    parameter->numeric = parameter->count > 0;
    for (size_t k = 0; k < parameter->count; k++)
        parameter->numeric &= !isnan(parameter->values[k].number);
    parameter->unit = parameter->numeric && gn_unit_is_shown(unit_of(parameter->meant))
                          ? unit_of(parameter->meant)
                          : "";
    if (strchr(parameter->unit, '|'))
        parameter->unit = ""; /* there are two alternatives, between which the scene decides */
    return GNEISS_OK;
}
