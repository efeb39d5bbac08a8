#include "runtime/result/sealed_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "dsl/base/sha256.h"
#include "runtime/result/hdf5_tools.h"

enum { DIGITS = SHA256_TEXT - 1, SMALL = 4096, SUM = 4, WORD = 8, TAIL = 2 * WORD + 16 };
static const char attribute_name[] = "seal", magic[16] = "perilat seal 1";

typedef struct byte_range {
  uint64_t from, to;
} byte_range;

typedef struct byte_ranges { /* left out */
  byte_range *items;
  size_t count;
  uint64_t seal; /* where its digits begin */
} byte_ranges;

static void put_word(unsigned char *at, uint64_t value) {
  for (int k = 0; k < WORD; k++)
    at[k] = (unsigned char)(value >> 8 * k);
}

static uint64_t get_word(const unsigned char *at) {
  uint64_t value = 0;
  for (int k = 0; k < WORD; k++)
    value |= (uint64_t)at[k] << 8 * k;
  return value;
}

/* --- the digest ------------------------------------------------------------------------------- */

static bool add_bytes(sha256 *h, int file, uint64_t from, uint64_t to) {
  static _Thread_local unsigned char block[1 << 16];
  while (from < to) {
    const size_t wanted = to - from < sizeof block ? (size_t)(to - from) : sizeof block;
    const ssize_t n = pread(file, block, wanted, (off_t)from);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    sha256_add(h, block, (size_t)n);
    from += (uint64_t)n;
  }
  return true;
}

/* False where the ranges do not lie in the file, one behind the other. */
static bool digest_of(int file, uint64_t size, const byte_ranges *r, char text[SHA256_TEXT]) {
  sha256 h;
  uint64_t at = 0;
  sha256_begin(&h);
  for (size_t k = 0; k < r->count; k++) {
    const byte_range out = r->items[k];
    if (out.from < at || out.to < out.from || out.to > size) return false;
    if (!add_bytes(&h, file, at, out.from)) return false;
    at = out.to;
  }
  if (!add_bytes(&h, file, at, size)) return false;
  sha256_text(&h, text);
  return true;
}

/* --- reading ---------------------------------------------------------------------------------- */

static bool read_at(int file, void *data, size_t bytes, uint64_t from) {
  return pread(file, data, bytes, (off_t)from) == (ssize_t)bytes;
}

/* What the end of the file says is left out; false where it says nothing of the kind. */
static bool read_ranges(int file, uint64_t size, byte_ranges *r) {
  unsigned char tail[TAIL];
  if (size < TAIL || !read_at(file, tail, TAIL, size - TAIL)) return false;
  *r = (byte_ranges){.seal = get_word(tail), .count = (size_t)get_word(tail + WORD)};
  if (memcmp(tail + 2 * WORD, magic, sizeof magic) != 0) return false;
  const uint64_t room = size - TAIL;
  if (r->count > room / sizeof(byte_range) || r->seal > room || room - r->seal < DIGITS)
    r->count = 0; /* the digest will not fit */
  unsigned char *words = must_alloc(2 * WORD * r->count + 1);
  r->items = must_alloc(r->count * sizeof *r->items + 1);
  if (!read_at(file, words, 2 * WORD * r->count, room - 2 * WORD * r->count)) r->count = 0;
  for (size_t k = 0; k < r->count; k++)
    r->items[k] =
        (byte_range){get_word(words + 2 * WORD * k), get_word(words + 2 * WORD * k + WORD)};
  free(words);
  return true;
}

static uint64_t size_of(int file) {
  struct stat about;
  return fstat(file, &about) == 0 && about.st_size > 0 ? (uint64_t)about.st_size : 0;
}

seal_state sealed_file_state(int file) {
  const uint64_t size = size_of(file);
  byte_ranges r;
  if (!read_ranges(file, size, &r)) return SEAL_NONE;
  char text[SHA256_TEXT], found[DIGITS];
  const bool whole = digest_of(file, size, &r, text) && read_at(file, found, DIGITS, r.seal) &&
                     memcmp(found, text, DIGITS) == 0;
  free(r.items);
  return whole ? SEAL_WHOLE : SEAL_BROKEN;
}

bool sealed_file_is_marked(hid_t file) {
  return H5Aexists(file, attribute_name) != 0; /* also where that cannot be told */
}

/* --- writing ---------------------------------------------------------------------------------- */

/* The library keeps a text of variable length as its length and its bytes, without a sum: what
   stands there can be put in when all else is written. */
static const char blank[] = "----------------------------------------------------------------";
_Static_assert(sizeof blank == SHA256_TEXT, "room for the digits");

hid_t sealed_file_create(const char *path) {
  const hid_t file = h5_create(path);
  if (file < 0 || h5_attribute_text(file, attribute_name, blank)) return file;
  H5Fclose(file);
  return -1;
}

/* Where the digits go: the file's first text. */
static bool find_blank(int file, uint64_t *place) {
  unsigned char wanted[WORD + DIGITS], block[1 << 16];
  put_word(wanted, DIGITS);
  memcpy(wanted + WORD, blank, DIGITS);
  for (uint64_t at = 0;; at += sizeof block - sizeof wanted) {
    const ssize_t n = pread(file, block, sizeof block, (off_t)at);
    for (ssize_t k = 0; k + (ssize_t)sizeof wanted <= n; k++)
      if (memcmp(block + k, wanted, sizeof wanted) == 0) {
        *place = at + (uint64_t)k + WORD;
        return true;
      }
    if (n < (ssize_t)sizeof block) return false;
  }
}

static void leave_out(byte_ranges *r, uint64_t from, uint64_t to) {
  if ((r->count & (r->count - 1)) == 0) /* full: twice as much */
    r->items = must_realloc(r->items, (2 * r->count + 1) * sizeof *r->items);
  r->items[r->count++] = (byte_range){from, to};
}

/* The last that is done to a chunk is that its sum is added. */
static bool has_sums(hid_t plist) {
  const int filters = H5Pget_layout(plist) == H5D_CHUNKED ? H5Pget_nfilters(plist) : 0;
  unsigned flags, config;
  size_t none = 0;
  return filters > 0 && H5Pget_filter2(plist, (unsigned)filters - 1, &flags, &none, NULL, 0, NULL,
                                       &config) == H5Z_FILTER_FLETCHER32;
}

/* The inside of each large chunk, all but its sum; not of those that could not be compressed: they
   lack the second sum, the compression's own. */
static bool leave_out_chunks(hid_t set, void *ranges) {
  const hid_t plist = H5Dget_create_plist(set), space = H5Dget_space(set);
  const bool summed = has_sums(plist);
  hsize_t count = 0, place[H5S_MAX_RANK], bytes;
  unsigned filters_left_out;
  haddr_t at;
  bool good = !summed || H5Dget_num_chunks(set, space, &count) >= 0;
  for (hsize_t k = 0; good && k < count; k++) {
    good = H5Dget_chunk_info(set, space, k, place, &filters_left_out, &at, &bytes) >= 0;
    if (good && bytes > SMALL && !filters_left_out) leave_out(ranges, at, at + bytes - SUM);
  }
  H5Sclose(space);
  H5Pclose(plist);
  return good;
}

static int by_place(const void *p, const void *q) {
  const byte_range *a = p, *b = q;
  return (a->from > b->from) - (a->from < b->from);
}

/* A set with two names tells of its chunks twice. */
static void sort_ranges(byte_ranges *r) {
  size_t kept = 0;
  qsort(r->items, r->count, sizeof *r->items, by_place);
  for (size_t k = 0; k < r->count; k++)
    if (k == 0 || r->items[k].from != r->items[kept - 1].from) r->items[kept++] = r->items[k];
  r->count = kept;
}

static bool write_ranges(int file, const byte_ranges *r) {
  const size_t bytes = 2 * WORD * r->count + TAIL;
  unsigned char *end = must_alloc(bytes), *at = end;
  for (size_t k = 0; k < r->count; k++, at += 2 * WORD) {
    put_word(at, r->items[k].from);
    put_word(at + WORD, r->items[k].to);
  }
  put_word(at, r->seal);
  put_word(at + WORD, r->count);
  memcpy(at + 2 * WORD, magic, sizeof magic);
  const bool good = pwrite(file, end, bytes, (off_t)size_of(file)) == (ssize_t)bytes;
  free(end);
  return good;
}

static bool write_digest(int file, const byte_ranges *r) {
  char text[SHA256_TEXT];
  return digest_of(file, size_of(file), r, text) &&
         pwrite(file, text, DIGITS, (off_t)r->seal) == DIGITS;
}

bool sealed_file_renew(int file) {
  byte_ranges r;
  if (!read_ranges(file, size_of(file), &r)) return false;
  const bool good = r.count > 0 && write_digest(file, &r);
  free(r.items);
  return good;
}

static bool seal(const char *path, byte_ranges *r) {
  const int file = open(path, O_RDWR | O_CLOEXEC);
  bool good = file >= 0 && find_blank(file, &r->seal);
  if (good) {
    leave_out(r, r->seal, r->seal + DIGITS);
    sort_ranges(r);
    good = write_ranges(file, r) && write_digest(file, r);
  }
  if (file >= 0) good = close(file) == 0 && good;
  return good;
}

bool sealed_file_close(hid_t file, const char *path) {
  byte_ranges r = {.items = NULL};
  bool good = H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0 && h5_each_set(file, leave_out_chunks, &r);
  good = H5Fclose(file) >= 0 && good;
  good = good && seal(path, &r);
  free(r.items);
  return good;
}
