#include "base/resident.h"
#include "io/h5_private.h"
#include "io/io.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void gn_h5_quiet(void) {
    (void)H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    (void)H5PLset_loading_state(0); /* files cannot load code as plugins */
}

typedef struct failure {
    char reason[256];
    bool no_memory;
} failure;

static herr_t look_at_failure(unsigned depth, const H5E_error2_t *entry, void *out) {
    failure *f = out;
    if (depth == 0 && entry->desc) snprintf(f->reason, sizeof f->reason, ": %s", entry->desc);
    f->no_memory = f->no_memory || entry->maj_num == H5E_RESOURCE ||
                   entry->min_num == H5E_NOSPACE || entry->min_num == H5E_CANTALLOC;
    return 0;
}

gneiss_status gn_h5_fail(const gn_h5 *file, gneiss_error *error, gneiss_status status,
                         const char *format, ...) {
    char what[512];
    failure found = {.no_memory = file->image.exhausted};
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    (void)H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, look_at_failure, &found);
    (void)H5Eclear2(H5E_DEFAULT);
    if (found.no_memory) status = GNEISS_ERROR_MEMORY;
    return gn_fail(error, status, "%s: %s%s", file->path, what, found.reason);
}

/* Resizes the image. A file that is being created is kept in memory and written at the end by plain
 * write calls: HDF5 1.10 does not survive a full disk (H5Fclose fails, keeps the file open and
 * tries again at exit), and errno would be lost. */
static void *image_resize(void *data, size_t size, H5FD_file_image_op_t op, void *udata) {
    (void)op;
    gn_h5_image *image = udata;
    if (size > image->capacity) {
        size_t capacity = size + size / 2 + 65536;
        void *more = realloc(data, capacity);
        image->exhausted = image->exhausted || !more;
        if (!more) return NULL;
        image->data = more;
        image->capacity = capacity;
    }
    image->size = size;
    return image->data;
}

/* Hands out the image of a file that is read, which is in memory already and is neither copied nor
 * resized. */
static void *image_hand_out(size_t size, H5FD_file_image_op_t op, void *udata) {
    (void)op;
    gn_h5_image *image = udata;
    return size <= image->size ? image->data : NULL;
}

static void *image_stay(void *to, const void *from, size_t size, H5FD_file_image_op_t op,
                        void *udata) {
    (void)op, (void)udata;
    return to == from ? to : memcpy(to, from, size);
}

static herr_t image_release(void *data, H5FD_file_image_op_t op, void *udata) {
    (void)data, (void)op, (void)udata; /* gn_h5_image owns the memory */
    return 0;
}
static void *image_udata_copy(void *udata) {
    return udata;
}
static herr_t image_udata_free(void *udata) {
    (void)udata;
    return 0;
}

/* In the format of HDF5 1.10 (superblock 3, object headers 2) all parts but raw chunks have a
 * checksum, and chunks have Fletcher32. Older formats have none, so that a flipped bit could remain
 * undetected. */
static hid_t image_access(gn_h5_image *image) {
    H5FD_file_image_callbacks_t callbacks = {
        .image_realloc = image_resize,
        .image_free = image_release,
        .udata_copy = image_udata_copy,
        .udata_free = image_udata_free,
        .udata = image,
    };
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    if (access < 0) return access;
    if (H5Pset_fapl_core(access, 1, 0) >= 0 &&
        H5Pset_file_image_callbacks(access, &callbacks) >= 0 &&
        H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110) >= 0 &&
        H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0)
        return access;
    H5Pclose(access);
    return -1;
}

hid_t gn_h5_untimed(hid_t class) {
    hid_t list = H5Pcreate(class);
    if (list >= 0) (void)H5Pset_obj_track_times(list, 0);
    return list;
}

static void create_image(gn_h5 *file, const char *name) {
    hid_t access = image_access(&file->image), creation = gn_h5_untimed(H5P_FILE_CREATE);
    if (access >= 0) file->id = H5Fcreate(name, H5F_ACC_TRUNC, creation, access);
    if (access >= 0) H5Pclose(access);
    if (creation >= 0) H5Pclose(creation);
}

void gn_h5_omit_digests(gn_h5 *file) {
    file->digested = false;
}

/* Memory that must be available, because HDF5 crashes without the 0.9 MB that opening a file takes.
 */
enum { OPENING_BYTES = 2 << 20 };

static gn_h5 *new_handle(const char *path, gneiss_error *error) {
    gn_h5 *file = calloc(1, sizeof *file);
    char *copy = strdup(path);
    if (!file || !copy || !gn_memory_is_left(OPENING_BYTES)) {
        gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory to open it", path);
        free(file);
        free(copy);
        return NULL;
    }
    file->path = copy;
    file->id = -1;
    file->target.descriptor = -1;
    return file;
}

gneiss_status gn_h5_create(const char *path, gn_h5 **out, gneiss_error *error) {
    gn_h5_quiet();
    *out = NULL;
    gn_h5 *file = new_handle(path, error);
    if (!file) return GNEISS_ERROR_MEMORY;
    gneiss_status status = gn_atomic_create(&file->target, path, error);
    if (status == GNEISS_OK) {
        file->writing = file->digested = true;
        /* HDF5 would first read an existing file of the given name; a path inside of a file cannot
         * exist. */
        char *name = gn_text_format("%s/image", file->target.temporary);
        if (name) create_image(file, name);
        free(name);
        if (file->id < 0)
            status = gn_h5_fail(file, error, GNEISS_ERROR_MEMORY, "cannot be begun in memory");
    }
    if (status != GNEISS_OK) {
        gn_h5_close(file);
        return status;
    }
    *out = file;
    return GNEISS_OK;
}

void gn_h5_load(void) {
    const double values[256] = {0};
    gn_h5_quiet();
    gn_h5 *file = new_handle("/dev/null/image", NULL);
    if (file) {
        file->writing = file->digested = true;
        create_image(file, file->path);
    }
    if (file && file->id >= 0 &&
        gn_h5_put(file, "group/set", GN_F64, 256, 1, 0, values, "m", "text", NULL) == GNEISS_OK &&
        gn_h5_seal(file, NULL) == GNEISS_OK)
        (void)H5Fflush(file->id, H5F_SCOPE_GLOBAL);
    gn_h5_close(file);
}

/* Refuses formats without checksums, because a damaged header of an older format can crash the
 * library. */
static gneiss_status check_signature(const gn_h5 *file, gneiss_error *error) {
    static const unsigned char expected[9] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n', 3};
    unsigned char found[9] = {0};
    int descriptor = open(file->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat info;
    if (descriptor < 0 || fstat(descriptor, &info) != 0) {
        int code = errno;
        if (descriptor >= 0) close(descriptor);
        return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be opened: %s", file->path,
                       strerror(code));
    }
    bool regular = S_ISREG(info.st_mode);
    ssize_t got = regular ? pread(descriptor, found, sizeof found, 0) : 0;
    int code = errno;
    close(descriptor);
    if (!regular)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected an HDF5 file, found a %s",
                       file->path, S_ISDIR(info.st_mode) ? "folder" : "device or pipe");
    if (got < 0)
        return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be read: %s", file->path,
                       strerror(code));
    if (got == 0)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected an HDF5 file, found an empty one",
                       file->path);
    if (memcmp(found, expected, 8) != 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected an HDF5 file, found something else (no HDF5 signature)",
                       file->path);
    if (found[8] != expected[8])
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected an HDF5 file of gneiss (superblock 3), found superblock %d",
                       file->path, found[8]);
    return GNEISS_OK;
}

static gneiss_status open_on_disk(gn_h5 *file, gneiss_error *error) {
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    /* Locks are not needed, because files appear complete by renaming, and some cluster file
     * systems have none. */
    (void)H5Pset_file_locking(access, 0, 1);
    (void)H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
    file->id = H5Fopen(file->path, H5F_ACC_RDONLY, access);
    (void)H5Pclose(access);
    if (file->id >= 0) return GNEISS_OK;
    return gn_h5_fail(file, error, GNEISS_ERROR_INPUT, "is damaged or truncated");
}

static gneiss_status open_image(gn_h5 *file, gneiss_error *error) {
    gn_h5_image *image = &file->image;
    GN_TRY(gn_read_bytes(file->path, &image->data, &image->size, error));
    H5FD_file_image_callbacks_t callbacks = {
        .image_malloc = image_hand_out,
        .image_memcpy = image_stay,
        .image_realloc = NULL,
        .image_free = image_release,
        .udata_copy = image_udata_copy,
        .udata_free = image_udata_free,
        .udata = image,
    };
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    char *name = gn_text_format("%s/image", file->path); /* a name that does not exist on disk */
    if (name && access >= 0 && H5Pset_fapl_core(access, 1, 0) >= 0 &&
        H5Pset_file_image_callbacks(access, &callbacks) >= 0 &&
        H5Pset_file_image(access, image->data, image->size) >= 0 &&
        H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0)
        file->id = H5Fopen(name, H5F_ACC_RDONLY, access);
    else
        image->exhausted = true;
    free(name);
    if (access >= 0) (void)H5Pclose(access);
    if (file->id >= 0) return GNEISS_OK;
    return gn_h5_fail(file, error, GNEISS_ERROR_INPUT, "is damaged or truncated");
}

static gneiss_status open_with(gneiss_status (*way)(gn_h5 *, gneiss_error *), const char *path,
                               gn_h5 **out, gneiss_error *error) {
    gn_h5_quiet();
    *out = NULL;
    gn_h5 *file = new_handle(path, error);
    if (!file) return GNEISS_ERROR_MEMORY;
    gneiss_status status = check_signature(file, error);
    if (status == GNEISS_OK) status = way(file, error);
    if (status == GNEISS_OK) file->digested = gn_h5_is_sealed(file->id);
    if (status != GNEISS_OK) {
        gn_h5_close(file);
        return status;
    }
    *out = file;
    return GNEISS_OK;
}

gneiss_status gn_h5_open(const char *path, gn_h5 **out, gneiss_error *error) {
    return open_with(open_on_disk, path, out, error);
}

gneiss_status gn_h5_open_whole(const char *path, gn_h5 **out, gneiss_error *error) {
    return open_with(open_image, path, out, error);
}

gneiss_status gn_h5_commit(gn_h5 **handle, gn_durability durability, gneiss_error *error) {
    gn_h5 *file = *handle;
    *handle = NULL;
    gn_h5_quiet();
    gneiss_status status = GNEISS_OK;
    if (!file->writing || file->failed)
        status = gn_fail(error, GNEISS_ERROR_INTERNAL, "%s: not committed: %s", file->path,
                         file->writing ? "a write into it failed" : "it was opened for reading");
    else if (file->digested && (status = gn_h5_seal(file, error)) != GNEISS_OK)
        file->failed = true;
    /* Flushing extends the image to its full size; closing marks it as closed. */
    else if (H5Fflush(file->id, H5F_SCOPE_GLOBAL) < 0)
        status = gn_h5_fail(file, error, GNEISS_ERROR_MEMORY, "cannot be completed in memory");
    else if (H5Fclose(file->id) < 0)
        status = gn_h5_fail(file, error, GNEISS_ERROR_MEMORY, "cannot be closed in memory");
    else if (file->id = -1, file->image.exhausted) /* HDF5 does not always report this failure */
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory to write it", file->path);
    else {
        status = gn_atomic_write(&file->target, file->image.data, file->image.size, error);
        if (status == GNEISS_OK) status = gn_atomic_commit(&file->target, durability, error);
    }
    gn_h5_close(file);
    return status;
}

void gn_h5_close(gn_h5 *file) {
    if (!file) return;
    gn_h5_quiet();
    if (file->writing) gn_atomic_abort(&file->target);
    /* If memory is lacking during closing, HDF5 still uses the image and accesses it at exit. */
    if (file->id >= 0 && H5Fclose(file->id) < 0) return;
    free(file->image.data);
    free(file->path);
    free(file);
}

void gn_h5_close_at(gn_h5 **file) {
    gn_h5_close(*file);
}
