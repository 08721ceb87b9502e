/* Records: allocation, padding, permutation, hash. */
#include "world_helpers.h"

#include "base/random.h"

static const gn_effects every = GN_FX_SPACE | GN_FX_ROTATION | GN_FX_PAIRS | GN_FX_CONTACT_FORCES |
                                GN_FX_SHEAR | GN_FX_FRICTION | GN_FX_BONDS | GN_FX_CONTACT_DAMPING |
                                GN_FX_APPLIED | GN_FX_PRESCRIBED | GN_FX_ORIENTATION | GN_FX_ENERGY;

static size_t bytes_of(const gn_field *f, size_t items) {
    return items * gn_type_size(f->type) * (size_t)f->components;
}

static gn_contacts contacts(size_t count, gn_effects effects) {
    gn_contacts k;
    assert_int_equal(gn_soa_create(&gn_contact_record, &k, count, effects, NULL), GNEISS_OK);
    return k;
}

static void fill(const gn_record *record, void *soa, uint64_t seed) {
    const gn_soa *head = soa;
    for (size_t f = 0; f < record->field_count; f++) {
        unsigned char *data = gn_field_data(&record->fields[f], soa);
        for (size_t b = 0; data && b < bytes_of(&record->fields[f], head->capacity); b++)
            data[b] = (unsigned char)gn_random_bits(seed + f, b);
    }
}

static void a_record_is_padded_aligned_and_zeroed(void **state) {
    (void)state;
    for (size_t count = 0; count < 70; count++) {
        gn_contacts k = contacts(count, every);
        assert_true(k.soa.capacity >= count + GN_LANES_MAX && k.soa.capacity % GN_LANES_MAX == 0);
        for (size_t f = 0; f < gn_contact_record.field_count; f++) {
            const unsigned char *data = gn_field_data(&gn_contact_record.fields[f], &k);
            assert_int_equal((uintptr_t)data % 64, 0);
            for (size_t b = 0; data && b < bytes_of(&gn_contact_record.fields[f], k.soa.capacity);
                 b++)
                assert_int_equal(data[b], 0);
        }
        gn_soa_destroy(&gn_contact_record, &k);
        assert_null(k.kn);
    }
}

static void only_fields_of_active_effects_are_allocated(void **state) {
    (void)state;
    gn_contacts bare = contacts(5, 0), flat = contacts(5, GN_FX_ROTATION | GN_FX_BONDS),
                full = contacts(5, every);
    assert_true(bare.kn && !bare.row4 && !bare.kt && !bare.mu && !bare.rn && !bare.rt &&
                !bare.row8);
    assert_true(flat.rn && !flat.row4 && !flat.rt &&
                !flat.row8); /* the column rt exists only with shear as well */
    assert_true(full.rt && full.fd && full.row8 && !full.row4);
    assert_true(gn_record_bytes(&gn_contact_record, 0) <
                gn_record_bytes(&gn_contact_record, every));
    gn_soa_destroy(&gn_contact_record, &bare);
    gn_soa_destroy(&gn_contact_record, &flat);
    gn_soa_destroy(&gn_contact_record, &full);
}

/* dst[k] = src[order[k]] in every field and component; negative: zeros. */
static void permutation_moves_every_component_of_every_field(void **state) {
    (void)state;
    enum { FROM = 61, TO = 45 };
    gn_contacts a = contacts(FROM, every), b = contacts(TO, every);
    int32_t order[TO];
    fill(&gn_contact_record, &a, 1);
    fill(&gn_contact_record, &b, 2);
    for (int k = 0; k < TO; k++) order[k] = k % 9 == 4 ? -1 : k * 17 % FROM;
    gn_soa_permute(&gn_contact_record, &b, &a, order);
    for (size_t f = 0; f < gn_contact_record.field_count; f++) {
        const gn_field *field = &gn_contact_record.fields[f];
        const char *x = gn_field_data(field, &a), *y = gn_field_data(field, &b);
        size_t size = gn_type_size(field->type), n = (size_t)field->components;
        const char zero[8] = {0};
        for (size_t k = 0; x && k < TO; k++)
            for (size_t c = 0; c < n; c++) {
                bool rows = field->layout == GN_ROWS;
                size_t to = rows ? k * n + c : c * b.soa.capacity + k, at = (size_t)order[k];
                size_t from = rows ? at * n + c : c * a.soa.capacity + at;
                assert_memory_equal(y + size * to, order[k] < 0 ? zero : x + size * from, size);
            }
    }
    gn_soa_destroy(&gn_contact_record, &a);
    gn_soa_destroy(&gn_contact_record, &b);
}

static void a_permutation_and_its_inverse_give_the_record_back(void **state) {
    (void)state;
    enum { COUNT = 53 };
    gn_particles a, b, c;
    gn_particles *all[] = {&a, &b, &c};
    int32_t there[COUNT], back[COUNT];
    for (int k = 0; k < 3; k++)
        assert_int_equal(gn_soa_create(&gn_particle_record, all[k], COUNT, every, NULL), GNEISS_OK);
    fill(&gn_particle_record, &a, 3);
    for (int k = 0; k < COUNT; k++) there[k] = k * 20 % COUNT;
    for (int k = 0; k < COUNT; k++) back[there[k]] = k;
    gn_soa_permute(&gn_particle_record, &b, &a, there);
    gn_soa_permute(&gn_particle_record, &c, &b, back);
    uint64_t start = gn_soa_hash(&gn_particle_record, &a, GN_HASH_SEED);
    assert_true(gn_soa_hash(&gn_particle_record, &b, GN_HASH_SEED) != start);
    assert_true(gn_soa_hash(&gn_particle_record, &c, GN_HASH_SEED) == start);
    for (int k = 0; k < 3; k++) gn_soa_destroy(&gn_particle_record, all[k]);
}

/* One byte of any component of any item decides if the field is state, and only then; padding
 * never. */
static void the_hash_depends_on_state_alone(void **state) {
    (void)state;
    gn_contacts k = contacts(37, every);
    fill(&gn_contact_record, &k, 5);
    uint64_t start = gn_soa_hash(&gn_contact_record, &k, GN_HASH_SEED);
    for (size_t f = 0; f < gn_contact_record.field_count; f++) {
        const gn_field *field = &gn_contact_record.fields[f];
        unsigned char *data = gn_field_data(field, &k);
        size_t size = gn_type_size(field->type),
               streams = field->layout == GN_ROWS ? 1 : (size_t)field->components;
        size_t item = field->layout == GN_ROWS ? size * (size_t)field->components : size;
        for (size_t s = 0; data && s < streams; s++)
            for (size_t b = 0; b < item * k.soa.capacity; b++) {
                unsigned char *byte = data + s * item * k.soa.capacity + b;
                bool seen = field->role == GN_STATE && b < item * k.soa.count;
                *byte ^= 0x10;
                bool differs = gn_soa_hash(&gn_contact_record, &k, GN_HASH_SEED) != start;
                *byte ^= 0x10;
                if (differs != seen) fail_msg("field %s, stream %zu, byte %zu", field->name, s, b);
            }
    }
    assert_true(gn_soa_hash(&gn_contact_record, &k, GN_HASH_SEED + 1) !=
                start); /* chains on its seed */
    gn_soa_destroy(&gn_contact_record, &k);
}

/* A rebuild must not lose the history of a contact: all of its state except the ends, by which it
 * is found again. */
static void all_state_of_a_contact_is_kept(void **state) {
    (void)state;
    const gn_record *records[] = {&gn_contact_record, &gn_wall_contact_record};
    const char *ends[][2] = {{"i", "j"}, {"i", "wall"}};
    for (int r = 0; r < 2; r++)
        for (size_t f = 0; f < records[r]->field_count; f++) {
            const gn_field *field = &records[r]->fields[f];
            bool end = !strcmp(field->name, ends[r][0]) || !strcmp(field->name, ends[r][1]);
            if (field->role != GN_STATE) continue;
            if (end == !!(field->care & GN_KEPT)) fail_msg("%s", field->name);
        }
}

/* A column that replaces a double exists exactly when the double does not. */
static void a_column_has_one_form_or_the_other_or_both(void **state) {
    (void)state;
    const gn_record *records[] = {&gn_contact_record, &gn_element_record};
    for (int r = 0; r < 2; r++)
        for (size_t f = 0; f < records[r]->field_count; f++) {
            const gn_field *single = &records[r]->fields[f], *wide = single;
            if (!single->single_of) continue;
            while (wide->offset != single->single_of)
                wide--; /* the double column precedes its copy */
            assert_true(single->type == GN_F32 && wide->type == GN_F64);
            assert_int_equal(single->components, wide->components);
            gn_effects asked = single->needs | single->unless | wide->needs;
            for (gn_effects e = asked, left = 1; left; left = e, e = (e - 1) & asked) {
                gn_effects beside = e | GN_FX_MIXED, alone = e & ~(gn_effects)GN_FX_MIXED;
                assert_false(gn_field_active(single, alone));
                bool there = gn_field_active(wide, alone);
                assert_true(gn_field_active(single, beside) == there);
                bool replaced = wide->unless & GN_FX_MIXED;
                assert_true(gn_field_active(wide, beside) == (there && !replaced));
            }
        }
}

/* FNV-1a, 64 bits: the published value for "foobar". */
static void the_hash_is_fnv_1a(void **state) {
    (void)state;
    assert_true(gn_hash_bytes("", 0, GN_HASH_SEED) == UINT64_C(0xcbf29ce484222325));
    assert_true(gn_hash_bytes("foobar", 6, GN_HASH_SEED) == UINT64_C(0x85944171f73967e8));
}

static void padded_contacts_join_null_particles(void **state) {
    (void)state;
    gn_particles p;
    assert_int_equal(gn_soa_create(&gn_particle_record, &p, 21, every, NULL), GNEISS_OK);
    fill(&gn_particle_record, &p, 6);
    gn_contacts k = contacts(19, every);
    gn_particles_set_null(&p, 0.25);
    gn_contacts_pad(&k, &p);
    for (size_t c = 19; c < k.soa.capacity; c++) {
        assert_int_equal(k.i[c], 21);
        assert_int_equal(k.j[c], 22);
    }
    assert_true(p.soa.capacity >= 23);
    const double *a = p.pos + 4 * 21, *b = p.pos + 4 * 22;
    assert_true(b[0] - a[0] == 0.25 && a[3] == 0.0 && b[3] == 0.0);
    gn_soa_destroy(&gn_particle_record, &p);
    gn_soa_destroy(&gn_contact_record, &k);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_record_is_padded_aligned_and_zeroed),
        cmocka_unit_test(only_fields_of_active_effects_are_allocated),
        cmocka_unit_test(permutation_moves_every_component_of_every_field),
        cmocka_unit_test(a_permutation_and_its_inverse_give_the_record_back),
        cmocka_unit_test(the_hash_depends_on_state_alone),
        cmocka_unit_test(all_state_of_a_contact_is_kept),
        cmocka_unit_test(a_column_has_one_form_or_the_other_or_both),
        cmocka_unit_test(the_hash_is_fnv_1a),
        cmocka_unit_test(padded_contacts_join_null_particles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
