/* The single list of scene keys. Parsing, defaults, range checks, overrides, the resolved echo and
 * the key reference all read these tables; a key is declared in manifest.c and nowhere else. */
#ifndef GN_SCENE_MANIFEST_H
#define GN_SCENE_MANIFEST_H

#include "scene/scene.h"
#include "scene/units.h"

typedef enum gn_key_type {
    GN_KEY_REAL,    /* double, a quantity in `unit` */
    GN_KEY_INTEGER, /* int64_t */
    GN_KEY_SEED,    /* uint64_t */
    GN_KEY_TEXT,    /* char[size] */
    GN_KEY_NAME,    /* char[size], a name: not empty, usable in an override */
    GN_KEY_FILE,    /* char[size], an existing file; its absolute path is stored at `second` */
    GN_KEY_CHOICE,  /* bool, enum or int64_t, depending on `size` */
    GN_KEY_VECTOR,  /* double[3]; two components in 2D scenes; if components may vary over time, the
                       gn_table[3] for them is at `second` */
    GN_KEY_SPIN,    /* double[3]; one number, about z, in 2D scenes */
    GN_KEY_CELLS,   /* int64_t[3]; two components in 2D scenes */
    GN_KEY_TABLE,   /* gn_table: constant, [[time, value], ...] or a formula of t */
    GN_KEY_IDS,     /* int64_t *, their count at `second` */
    GN_KEY_PARTICLES, /* double *, their count at `second`; rows [x, y, z, r], in 2D [x, y, r]; or a
                         whole number in `range` instead, which goes to the int64_t at `number` */
    GN_KEY_POINTS,    /* double *, their count at `second`; rows [x, y], at least 3 or `number` */
    GN_KEY_NAMES,     /* char (*)[GN_NAME_SIZE], their count at `second`; one name, or a list */
    GN_KEY_TREE, /* const gn_node *, any YAML value, which its owner reads; `unit` describes it */
    GN_KEY_CHANGES, /* char *, bytes at `second`: keys of the scene that a stage changes, extracted
                       by stages.c; no key of a file has this name */
    GN_KEY_SECTION, /* the keys of `section`, in the struct at `offset` */
    GN_KEY_LIST     /* a pointer to structs, their count at `second`; each read by `section` */
} gn_key_type;

/* Member of the struct that tells whether an optional key or section was given; a key that was not
 * given is not written. */
typedef enum gn_presence {
    GN_PRESENT_ALWAYS,
    GN_PRESENT_BOOL,  /* bool, set when the key is read */
    GN_PRESENT_ENUM,  /* an enum that is not 0 */
    GN_PRESENT_AXIS,  /* int64_t, -1 when absent */
    GN_PRESENT_COUNT, /* size_t that is not 0 */
    GN_PRESENT_NONE,  /* size_t that is 0: another list replaces this one */
    GN_PRESENT_TEXT,  /* char[] that is not empty */
    GN_PRESENT_ROWS,  /* for GN_KEY_PARTICLES: rows, or their requested number */
    GN_PRESENT_SHAPE, /* gn_shape_kind that equals the key's */
    GN_PRESENT_BESIDE /* an enum that is not 0; a section that is not given takes its defaults */
} gn_presence;

/* A word of the file and its value in the struct. The array ends with a NULL name; of several words
 * for one value the first is written. */
typedef struct gn_choice {
    const char *name;
    int64_t value;
} gn_choice;

typedef struct gn_section gn_section;

typedef struct gn_key {
    const char *name;
    gn_key_type type;
    size_t offset, size; /* of the member in the struct of the section */
    size_t second;       /* see gn_key_type */
    size_t number;       /* see GN_KEY_PARTICLES, GN_KEY_POINTS */
    bool required;       /* a section without the key is an error */
    const char
        *fallback; /* default as written in a file (for each component of a vector); NULL: none */
    const char *unit;  /* SI unit of numbers, "1": none; "1/s|1": one of the two; GN_SLOPE,
                          GN_PLAIN_NUMBER, GN_EVENT_RATE */
    const char *range; /* interval in that unit, such as "(0, 1]"; NULL: any finite number */
    const char *word;  /* word accepted instead of a number, such as "auto"; for a section: gives
                          each key its own word */
    double word_value; /* value in the struct that the word means */
    const char *other_word; /* a second word accepted instead of a number, with its value */
    double other_value;
    const gn_choice *choices; /* for GN_KEY_CHOICE */
    size_t place_at; /* offset of the gn_scene_place that stores where the value is in the file, for
                        later messages; 0: none */
    gn_presence presence;
    size_t present_at;   /* offset of the member that `presence` refers to */
    gn_shape_kind shape; /* shape that the key selects; GN_SHAPE_NONE: none */
    int shape_dimension; /* dimension of scenes that can have the key; 0: any */
    bool packing;        /* section of the scene that gn_scene_load_specimen reads */
    const gn_section *section;
    const char *in_folder; /* for GN_KEY_FILE: name of the file to use if the path is a folder;
                              NULL: folders are refused */
    const char *text;      /* one line of explanation */
} gn_key;

enum { GN_NO_WHERE = -1, GN_SECTION_KEYS_MAX = 48 };

struct gn_section {
    const gn_key *keys;
    size_t key_count;
    size_t size; /* size of an element of a list */
    long where;  /* offset of the gn_scene_place to set; GN_NO_WHERE: none */
};

/* Range of lengths and coordinates, m; see GN_LENGTH_LEAST and GN_PLACE_MOST. */
#define GN_LENGTHS "[1e-9, 1e9]"
#define GN_PLACES  "[-1e9, 1e9]"

/* Sections of the whole scene, and of its specimen. */
extern const gn_section gn_scene_section, gn_specimen_section;
/* An element of `bodies` (manifest_bodies.c). */
extern const gn_section gn_body_section;
/* A distribution of bonds of a material; an element of `contacts`. */
extern const gn_section gn_scatter_section, gn_contact_section;
/* An element of `stages` (manifest_test.c). */
extern const gn_section gn_stage_section;

/* An interval "[low, high)", and a test whether it contains a value. NULL: every finite value. */
typedef struct gn_range {
    double low, high;
    bool low_open, high_open;
} gn_range;
gn_range gn_range_read(const char *text);
bool gn_range_holds(const char *text, double value);

/* Returns the key of a scene at a path like that of an override (walls.top.motion.vz, gravity[2]:
 * the vector); NULL: there is none. Elements of lists need not exist. */
const gn_key *gn_scene_key_at(const char *path);

/* Writes which values a key accepts: "number, m, in (0, inf), or auto". */
enum { GN_KEY_TYPE_SIZE = 256 };
void gn_key_describe(const gn_key *key, char *text, size_t size);

/* Writes the default of a key, or "required"; "": it has none. */
void gn_key_default(const gn_key *key, char *text, size_t size);

/* Calls `visit` for every key of a scene with its path, such as walls[].motion.vz. */
typedef void gn_key_visit(void *context, const char *path, const gn_key *key);
void gn_scene_visit_keys(gn_key_visit *visit, void *context);

/* Prints the keys of any table as rows of a Markdown table. */
void gn_section_print_keys(FILE *out, const gn_section *section);

/* True if the key is present in the struct `base` of its section. */
bool gn_key_present(const gn_key *key, const void *base);

/* Returns the size in bytes of an element of the array that belongs to a key; 0: it has no array.
 */
size_t gn_key_element_size(const gn_key *key);

/* Lists the shapes of a dimension: "box, cylinder, ...". */
enum { GN_SHAPE_NAMES_SIZE = 128 };
void gn_shape_names(int64_t dimension, char names[GN_SHAPE_NAMES_SIZE]);

/* Returns the number of tables of a key, and the first of them in the struct `base` of its section.
 */
size_t gn_key_tables(const gn_key *key, void *base, gn_table **first);

/* gn_choice_load returns the value of a GN_KEY_CHOICE at its address, gn_choice_store writes it. */
int64_t gn_choice_load(const gn_key *key, const void *at);
void gn_choice_store(const gn_key *key, void *at, int64_t value);
const char *gn_choice_name(const gn_choice *choices, int64_t value);

#endif
