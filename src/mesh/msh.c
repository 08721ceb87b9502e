/* gmsh .msh: sections, header, names of groups. Format: Gmsh reference manual, "MSH file format"
 * (4.1) and "Legacy formats" (2.0 to 2.2, 4.0). */
#define _GNU_SOURCE /* memmem */
#include "mesh/mesh_private.h"

#include "base/memory.h"
#include "base/printable.h"

#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FORMAT, NAMES, ENTITIES, NODES, ELEMENTS, PARTITIONED, SECTIONS, SECTION_NAME_SIZE = 64 };

static const char *const section_name[SECTIONS] = {
    "$MeshFormat", "$PhysicalNames", "$Entities", "$Nodes", "$Elements", "$PartitionedEntities"};

/* A section: its content is [begin, end). `header` is the offset of its name; SIZE_MAX: there is no
 * such section. */
typedef struct section {
    size_t header, begin, end;
} section;

static bool is_letter(unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/* Reads $Name and the rest of its line; leaves `at` after the line. */
static gneiss_status take_header(gn_mesh_source *in, char name[SECTION_NAME_SIZE]) {
    size_t start = in->at, length = 1;
    if (in->bytes[start] != '$')
        return gn_mesh_refuse(in, start, "expected a section ($Nodes, ...), found '%s'%s",
                              gn_mesh_show(in, start).text,
                              start ? "" : "; gneiss convert writes meshes of others as .msh");
    while (is_letter(in->bytes[start + length])) length++;
    if (length == 1 || length >= SECTION_NAME_SIZE - 4 ||
        memcmp(in->bytes + start, "$End", length < 4 ? length : 4) == 0)
        return gn_mesh_refuse(in, start, "expected the name of a section, found '%s'",
                              gn_mesh_show(in, start).text);
    memcpy(name, in->bytes + start, length);
    name[length] = '\0';
    in->at = start + length;
    while (gn_mesh_is_blank(in->bytes[in->at])) in->at++;
    size_t line_end = in->at;
    if (in->bytes[in->at] == '\r') in->at++;
    if (in->bytes[in->at] == '\n') in->at++;
    if (in->at == line_end && in->at < in->size)
        return gn_mesh_refuse(in, in->at, "expected the end of the line behind %s, found '%s'",
                              name, gn_mesh_show(in, in->at).text);
    return GNEISS_OK;
}

/* Refuses format 1, which has no header: its sections are $NOD and $ELM, which end with $ENDNOD and
 * $ENDELM. */
static gneiss_status refuse_format_1(const gn_mesh_source *in, const char *name, size_t at) {
    if (strcmp(name, "$NOD") != 0 && strcmp(name, "$ELM") != 0) return GNEISS_OK;
    return gn_mesh_refuse(in, at,
                          "expected format 2.0 to 4.1, found a section %s of format 1; gmsh -save "
                          "-format msh41 -o NEW.msh OLD.msh writes it anew",
                          name);
}

/* Finds $EndName, by which alone the length of unknown and of binary sections is known. */
static gneiss_status find_end(gn_mesh_source *in, const char *name, section *found) {
    char mark[SECTION_NAME_SIZE];
    size_t length = (size_t)snprintf(mark, sizeof mark, "$End%s", name + 1);
    found->begin = in->at;
    for (size_t at = in->at; at < in->size;) {
        const unsigned char *hit = memmem(in->bytes + at, in->size - at, mark, length);
        if (!hit) break;
        at = (size_t)(hit - in->bytes) + length;
        if (at < in->size && !gn_mesh_is_space(in->bytes[at])) continue;
        found->end = at - length;
        in->at = at;
        return GNEISS_OK;
    }
    return gn_mesh_refuse(in, found->header,
                          "expected %s behind %s, found the end of the file (cut short?)", mark,
                          name);
}

/* Finds all sections before one is read, because they may come in any order. */
static gneiss_status find_sections(gn_mesh_source *in, section found[SECTIONS]) {
    for (int s = 0; s < SECTIONS; s++) found[s].header = SIZE_MAX;
    for (;;) {
        char name[SECTION_NAME_SIZE];
        gn_mesh_next_row(in);
        if (in->at == in->size) return GNEISS_OK;
        section one = {.header = in->at};
        GN_TRY(take_header(in, name));
        GN_TRY(refuse_format_1(in, name, one.header));
        GN_TRY(find_end(in, name, &one));
        for (int s = 0; s < SECTIONS; s++) {
            if (strcmp(name, section_name[s]) != 0) continue;
            if (found[s].header != SIZE_MAX)
                return gn_mesh_refuse(in, one.header, "expected one section %s, found a second",
                                      name);
            found[s] = one;
        }
    }
}

static bool enter(gn_mesh_source *in, const section found[SECTIONS], int s) {
    if (found[s].header == SIZE_MAX) return false;
    in->section = section_name[s];
    in->at = found[s].begin;
    in->end = found[s].end;
    in->binary = false;
    return true;
}

/* Returns 10 times the version, which may lack its second digit; 0: unknown. */
static int version_of(const char *text, size_t length) {
    static const struct {
        const char *text;
        int version;
    } known[] = {{"2", 20}, {"2.0", 20}, {"2.1", 21}, {"2.2", 22},
                 {"4", 40}, {"4.0", 40}, {"4.1", 41}};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (strlen(known[k].text) == length && memcmp(text, known[k].text, length) == 0)
            return known[k].version;
    return 0;
}

static gneiss_status read_version(gn_msh *msh, bool *binary) {
    gn_mesh_source *in = &msh->in;
    size_t start, length;
    int64_t type, size;
    gn_mesh_next_row(in);
    GN_TRY(gn_mesh_take_field(in, "the format's version", &start, &length));
    const char *text = (const char *)in->bytes + start;
    msh->version = version_of(text, length);
    if (!msh->version)
        return gn_mesh_refuse(in, start,
                              "expected format 2.0 to 2.2, 4.0 or 4.1 (gmsh -format msh41), found "
                              "'%s'",
                              gn_mesh_show(in, start).text);
    GN_TRY(gn_mesh_take_integer(in, "file type (0 text, 1 binary)", 4, 0, 1, &type));
    start = gn_mesh_field_start(in);
    GN_TRY(gn_mesh_take_integer(in, "data size", 4, 1, INT32_MAX, &size));
    if (size != 8)
        return gn_mesh_refuse(in, start, "expected data of 8 bytes, found %lld", (long long)size);
    *binary = type == 1;
    return GNEISS_OK;
}

static gneiss_status check_byte_order(gn_mesh_source *in) {
    int64_t one;
    if (in->at < in->end && in->bytes[in->at] == '\r') in->at++;
    if (in->at < in->end && in->bytes[in->at] == '\n') in->at++;
    in->binary = true;
    size_t start = gn_mesh_field_start(in);
    GN_TRY(gn_mesh_take_integer(in, "the number 1", 4, INT32_MIN, INT32_MAX, &one));
    if (one == INT64_C(0x01000000))
        return gn_mesh_refuse(in, start,
                              "expected the byte order of this machine, found the "
                              "other one (gmsh -format msh41 writes text)");
    if (one != 1)
        return gn_mesh_refuse(in, start, "expected the number 1, found %lld", (long long)one);
    return GNEISS_OK;
}

/* Reads from the first quote to the last one of the line. */
static gneiss_status take_name(gn_mesh_source *in, char name[GN_MESH_NAME_SIZE]) {
    size_t start = gn_mesh_field_start(in), last = start;
    if (start == in->end || in->bytes[start] != '"')
        return gn_mesh_refuse(in, start, "expected a name in double quotes, found '%s'",
                              gn_mesh_show(in, start).text);
    for (; in->at < in->end && in->bytes[in->at] != '\n' && in->bytes[in->at] != '\r'; in->at++) {
        if (in->bytes[in->at] == '"') last = in->at;
        if (in->bytes[in->at] == '\0')
            return gn_mesh_refuse(in, in->at, "expected a name, found a zero byte");
    }
    if (last == start)
        return gn_mesh_refuse(in, start,
                              "expected a second quote behind the name, found the end "
                              "of the line");
    size_t length = last - start - 1;
    if (length >= GN_MESH_NAME_SIZE)
        return gn_mesh_refuse(in, start, "expected a name of at most %d bytes, found %zu",
                              GN_MESH_NAME_SIZE - 1, length);
    memcpy(name, in->bytes + start + 1, length);
    name[length] = '\0';
    gn_make_printable(name);
    in->at = last + 1;
    return GNEISS_OK;
}

typedef struct group_set {
    gn_mesh *mesh;
    size_t capacity;
    gn_mesh_table known;
    bool without_dimension; /* names hold for all dimensions */
} group_set;

static gneiss_status add_group(const gn_mesh_source *in, group_set *set, const gn_mesh_group *group,
                               bool *is_new) {
    gn_mesh *mesh = set->mesh;
    int64_t next = (int64_t)mesh->group_count, held;
    gn_mesh_key key = {(uint64_t)group->dimension, (uint64_t)group->tag};
    void *groups = mesh->groups;
    if (!gn_mesh_table_add(&set->known, key, next, &held)) return gn_mesh_no_memory(in);
    *is_new = held == next;
    if (!*is_new) return GNEISS_OK;
    if (!gn_mesh_grow(&groups, &set->capacity, mesh->group_count, mesh->group_count + 1,
                      sizeof *group))
        return gn_mesh_no_memory(in);
    mesh->groups = groups;
    mesh->groups[mesh->group_count++] = *group;
    return GNEISS_OK;
}

/* Reads a name and adds its group; in format 2.0 a name has no dimension, and holds for all. */
static gneiss_status read_group(gn_mesh_source *in, group_set *set) {
    gn_mesh_group group = {0};
    int64_t dimension, tag;
    bool is_new;
    gn_mesh_next_row(in);
    size_t start = gn_mesh_field_start(in);
    GN_TRY(gn_mesh_take_integer(in, "dimension of a physical group", 4, 0, INT32_MAX, &dimension));
    const bool all = in->bytes[gn_mesh_field_start(in)] == '"';
    tag = dimension;
    if (!all && dimension > 3)
        return gn_mesh_refuse(in, start,
                              "expected dimension of a physical group from 0 to 3, found %lld",
                              (long long)dimension);
    if (!all) GN_TRY(gn_mesh_take_integer(in, "tag of a physical group", 4, 1, INT32_MAX, &tag));
    GN_TRY(take_name(in, group.name));
    group.tag = (int32_t)tag;
    for (group.dimension = all ? 0 : (int)dimension; group.dimension <= (all ? 3 : (int)dimension);
         group.dimension++) {
        GN_TRY(add_group(in, set, &group, &is_new));
        if (!is_new)
            return gn_mesh_refuse(in, start,
                                  "expected one name of group %lld of dimension %d, found a "
                                  "second",
                                  (long long)tag, group.dimension);
    }
    set->without_dimension |= all;
    return GNEISS_OK;
}

static gneiss_status read_names(gn_mesh_source *in, group_set *set) {
    int64_t count;
    gn_mesh_next_row(in);
    GN_TRY(gn_mesh_take_integer(in, "number of names", 4, 0, INT64_MAX, &count));
    GN_TRY(gn_mesh_check_count(in, "names", count, sizeof "1 \"\"", 1));
    for (int64_t k = 0; k < count; k++) GN_TRY(read_group(in, set));
    return gn_mesh_end_section(in);
}

static bool has_elements(const gn_msh *msh, const gn_mesh_group *group) {
    const gn_mesh_elements *e = msh->list[group->dimension].elements;
    for (size_t k = 0; k < e->count + e->also_count; k++)
        if ((k < e->count ? e->group[k] : e->also[k - e->count].group) == group->tag) return true;
    return false;
}

/* Drops groups of dimensions that a name of format 2.0 did not mean. */
static void drop_empty_groups(const gn_msh *msh) {
    gn_mesh *mesh = msh->mesh;
    size_t kept = 0;
    for (size_t g = 0; g < mesh->group_count; g++)
        if (has_elements(msh, &mesh->groups[g])) mesh->groups[kept++] = mesh->groups[g];
    mesh->group_count = kept;
}

static int by_dimension_and_tag(const void *a, const void *b) {
    const gn_mesh_group *p = a, *q = b;
    if (p->dimension != q->dimension) return p->dimension - q->dimension;
    return (p->tag > q->tag) - (p->tag < q->tag);
}

/* Adds groups without a name, which only their elements show. */
static gneiss_status add_unnamed_groups(gn_msh *msh, group_set *set) {
    bool is_new;
    for (int d = 0; d <= 3; d++) {
        const gn_mesh_elements *e = msh->list[d].elements;
        gn_mesh_group group = {.dimension = d};
        for (size_t k = 0; k < e->count + e->also_count; k++) {
            group.tag = k < e->count ? e->group[k] : e->also[k - e->count].group;
            if (group.tag) GN_TRY(add_group(&msh->in, set, &group, &is_new));
        }
    }
    if (set->mesh->group_count)
        qsort(set->mesh->groups, set->mesh->group_count, sizeof *set->mesh->groups,
              by_dimension_and_tag);
    return GNEISS_OK;
}

static gneiss_status read_sections(gn_msh *msh, group_set *set) {
    gn_mesh_source *in = &msh->in;
    section found[SECTIONS];
    bool binary = false;
    GN_TRY(find_sections(in, found));
    if (!enter(in, found, FORMAT))
        return gn_fail(in->error, GNEISS_ERROR_INPUT,
                       "%s: expected a gmsh mesh of format 2.0 to 4.1, found no $MeshFormat",
                       in->path);
    GN_TRY(read_version(msh, &binary));
    in->by_offset = binary;
    if (binary) GN_TRY(check_byte_order(in));
    GN_TRY(gn_mesh_end_section(in));
    for (int s = NODES; s <= ELEMENTS; s++)
        if (found[s].header == SIZE_MAX)
            return gn_fail(in->error, GNEISS_ERROR_INPUT, "%s: expected a section %s, found none",
                           in->path, section_name[s]);
    if (enter(in, found, NAMES)) GN_TRY(read_names(in, set));
    for (int s = ENTITIES; s <= PARTITIONED; s += PARTITIONED - ENTITIES) {
        if (msh->version < 40 || !enter(in, found, s)) continue;
        in->binary = binary;
        GN_TRY(gn_msh_read_entities(msh, s == PARTITIONED));
    }
    enter(in, found, NODES);
    in->binary = binary;
    GN_TRY(gn_msh_read_nodes(msh));
    enter(in, found, ELEMENTS);
    in->binary = binary;
    GN_TRY(gn_msh_read_elements(msh));
    GN_TRY(add_unnamed_groups(msh, set));
    if (set->without_dimension) drop_empty_groups(msh);
    return GNEISS_OK;
}

gneiss_status gn_mesh_read_msh(const char *path, double scale, gn_mesh *mesh, gneiss_error *error) {
    *mesh =
        (gn_mesh){.points.nodes = 1, .lines.nodes = 2, .triangles.nodes = 3, .tetrahedra.nodes = 4};
    gn_msh msh = {.mesh = mesh};
    msh.list[0].elements = &mesh->points;
    msh.list[1].elements = &mesh->lines;
    msh.list[2].elements = &mesh->triangles;
    msh.list[3].elements = &mesh->tetrahedra;
    group_set set = {.mesh = mesh};
    gneiss_status status = gn_mesh_source_open(&msh.in, path, scale, error);
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (status == GNEISS_OK && !plain) status = gn_mesh_no_memory(&msh.in);
    if (status == GNEISS_OK) {
        locale_t before = uselocale(plain); /* the calling program may have set a decimal comma */
        status = read_sections(&msh, &set);
        uselocale(before);
    }
    if (plain) freelocale(plain);
    gn_mesh_source_close(&msh.in);
    gn_mesh_table_free(&set.known);
    gn_mesh_table_free(&msh.node_index);
    gn_mesh_table_free(&msh.entity);
    gn_free(msh.entity_first);
    gn_free(msh.entity_group);
    gn_free(msh.inner);
    if (status != GNEISS_OK) gn_mesh_free(mesh);
    return status;
}
