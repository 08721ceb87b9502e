/* Chunks as they are stored, each with its checksum behind it: handed to the file as they are, they
 * go past HDF5's cache of chunks and its filters, which take several times as long. */
#include "base/memory.h"
#include "io/h5_private.h"

#include <string.h>

/* Sums of 16-bit words modulo 65535, Fletcher, J. G. (1982), An arithmetic checksum for serial
 * transmissions, IEEE Trans. Commun. 30, 247-252. A sum that is not of nothing but zeros is never
 * 0 but 65535, as it is when carries are added at the end. */
enum { MODULUS = 65535, WORDS = 256 /* whose weighted sum has room in 32 bits */ };

static uint32_t canonical(uint64_t sum, bool any) {
    uint32_t rest = (uint32_t)(sum % MODULUS);
    return any && rest == 0 ? MODULUS : rest;
}

/* Words are big-endian in the checksum and little-endian here: to exchange the bytes of a sum of
 * words is to multiply it by 256. */
uint32_t gn_h5_checksum(const void *data, size_t bytes) {
    const unsigned char *at = data;
    uint64_t plain = 0, weighted = 0;
    bool any = false;
    for (size_t left = bytes; left > 0;) {
        uint16_t word[WORDS] = {0};
        const size_t taken = left < sizeof word ? left : sizeof word, words = (taken + 1) / 2;
        memcpy(word, at, taken);
        uint32_t sum = 0, steps = 0;
        for (uint32_t k = 0; k < WORDS; k++) {
            sum += word[k];
            steps += k * word[k];
        }
        any = any || sum > 0;
        weighted = (weighted + words * plain + (uint64_t)words * sum - steps) % MODULUS;
        plain = (plain + sum) % MODULUS;
        at += taken;
        left -= taken;
    }
    return canonical(256 * weighted, any) << 16 | canonical(256 * plain, any);
}

/* Where a file holds numbers in the order of this machine. */
static bool as_in_memory(gn_type type) {
    return H5Tequal(gn_h5_file_type(type), gn_h5_memory_type(type)) > 0;
}

bool gn_h5_write_chunks(hid_t set, gn_type type, gn_h5_shape shape, size_t bytes, const void *data,
                        bool *done) {
    hsize_t chunk[2] = {0, 1};
    hid_t creation = H5Dget_create_plist(set);
    *done = false;
    bool chunked = creation >= 0 && H5Pget_layout(creation) == H5D_CHUNKED &&
                   H5Pget_chunk(creation, 2, chunk) == shape.rank;
    if (creation >= 0) H5Pclose(creation);
    if (!chunked || !as_in_memory(type) || (shape.rank == 2 && chunk[1] != shape.size[1]))
        return true;
    const size_t size = bytes / shape.size[0] * chunk[0];
    unsigned char *stored = gn_alloc_array_raw(size + 4, 1);
    bool fine = stored != NULL;
    for (hsize_t row = 0; fine && row < shape.size[0]; row += chunk[0]) {
        const hsize_t place[2] = {row, 0};
        const size_t begin = bytes / shape.size[0] * row;
        const size_t taken = bytes - begin < size ? bytes - begin : size;
        memcpy(stored, (const char *)data + begin, taken);
        memset(stored + taken, 0, size - taken);
        const uint32_t sum = gn_h5_checksum(stored, size);
        for (int k = 0; k < 4; k++) stored[size + (size_t)k] = (unsigned char)(sum >> (8 * k));
        fine = H5Dwrite_chunk(set, H5P_DEFAULT, 0, place, size + 4, stored) >= 0;
    }
    gn_free(stored);
    *done = fine;
    return fine;
}
