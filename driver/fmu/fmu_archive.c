/* An FMU as a zip archive, by minizip. */
#include "base/memory.h"
#include "base/write_bytes.h"
#include "files/output_file.h"
#include "fmu/fmu_write.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <zip.h>
#include <zlib.h>

static bool copy(zipFile archive, const char *path)
{
    char part[1 << 16];
    size_t n = sizeof part;
    FILE *from = fopen(path, "rb");
    bool good = from != NULL;
    while (good && n == sizeof part) { /* fewer bytes: the end, or an error */
        n = fread(part, 1, sizeof part, from);
        good = zipWriteInFileInZip(archive, part, (unsigned)n) == ZIP_OK;
    }
    good = good && ferror(from) == 0;
    return from != NULL && fclose(from) == 0 && good;
}

static bool put(zipFile archive, const fmu_file *file)
{
    /* the earliest date of a zip archive for all files, so that the same case gives the same bytes */
    const zip_fileinfo info = {.tmz_date = {.tm_mday = 1, .tm_year = 1980}};
    if (zipOpenNewFileInZip(archive, file->name, &info, NULL, 0, NULL, 0, NULL, Z_DEFLATED, Z_DEFAULT_COMPRESSION) !=
        ZIP_OK) {
        return false;
    }
    const bool good = file->path != NULL
                          ? copy(archive, file->path)
                          : zipWriteInFileInZip(archive, file->text, (unsigned)strlen(file->text)) == ZIP_OK;
    return zipCloseFileInZip(archive) == ZIP_OK && good;
}

/** Buffer of an archive. */
typedef struct {
    char *bytes;
    size_t n;
} heap;

static voidpf open_heap(voidpf opaque, const char *name, int mode)
{
    heap *h = opaque;
    (void)name, (void)mode;
    return memory_open(&h->bytes, &h->n);
}

/** Write all files in memory: minizip seeks back in its output, which would be lost on an interrupt. */
static bool fill(heap *h, int n, const fmu_file *files)
{
    zlib_filefunc_def in_memory;
    fill_fopen_filefunc(&in_memory);
    in_memory.zopen_file = open_heap;
    in_memory.opaque = h;
    zipFile archive = zipOpen2("", APPEND_STATUS_CREATE, NULL, &in_memory);
    bool good = archive != NULL;
    for (int i = 0; i < n && good; i++) {
        good = put(archive, &files[i]);
    }
    return archive != NULL && zipClose(archive, NULL) == ZIP_OK && good && h->bytes != NULL;
}

bool fmu_archive(const char *path, int n, const fmu_file *files, evl_error *error)
{
    output_file output;
    heap h = {NULL, 0};
    if (!output_file_open(&output, path, error)) {
        return false;
    }
    output.is_open_end = true; /* an archive has its own checksums, and must not be followed by other bytes */
    errno = 0;
    const bool good = fill(&h, n, files) && write_bytes(output.descriptor, 0, h.bytes, h.n) == h.n;
    free(h.bytes);
    if (!good) {
        (void)output_file_refuse(path, errno == 0 ? EIO : errno, NULL, error);
        output_file_drop(&output, true);
        return false;
    }
    return output_file_close(&output, true, error);
}
