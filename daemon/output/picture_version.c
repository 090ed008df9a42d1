// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/picture_version.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MAGIC = 20000630, PREAMBLE_BYTES = 8, HEADER_BYTES = 1 << 15 };

struct attribute {
    const char *name, *type;
    const uint8_t *value;
    size_t size;
};

static uint32_t read_word(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

// The text at `*at`, which moves behind it; NULL: it has no end.
static const char *read_text(const uint8_t **at, const uint8_t *end)
{
    const uint8_t *start = *at, *nul = memchr(start, '\0', (size_t)(end - start));

    if (!nul) return NULL;
    *at = nul + 1;
    return (const char *)start;
}

static bool read_attribute(struct attribute *attribute, const uint8_t **at, const uint8_t *end)
{
    attribute->name = read_text(at, end);
    if (!attribute->name || !*attribute->name) return false; // an empty name ends the header
    attribute->type = read_text(at, end);
    if (!attribute->type || end - *at < 4) return false;
    attribute->size = read_word(*at);
    *at += 4;
    if (attribute->size > (size_t)(end - *at)) return false;
    attribute->value = *at;
    *at += attribute->size;
    return true;
}

static bool is_attribute(const struct attribute *attribute, const char *name, const char *type, size_t size)
{
    return strcmp(attribute->name, name) == 0 && strcmp(attribute->type, type) == 0 && attribute->size == size;
}

bool picture_version_parse(struct picture_version *version, const uint8_t *bytes, size_t size)
{
    const uint8_t *at = bytes + PREAMBLE_BYTES, *end = bytes + size;
    struct attribute attribute;

    *version = (struct picture_version){0};
    if (size < PREAMBLE_BYTES || read_word(bytes) != MAGIC) return false;
    while (read_attribute(&attribute, &at, end)) {
        if (is_attribute(&attribute, "marchd:sequenceHash", "string", HASH_TEXT_SIZE - 1))
            memcpy(version->hash, attribute.value, HASH_TEXT_SIZE - 1);
        if (is_attribute(&attribute, "marchd:draft", "int", 4)) version->is_draft = read_word(attribute.value) != 0;
    }
    return version->hash[0] != '\0';
}

bool picture_version_read(struct picture_version *version, int folder, const char *name)
{
    int fd = openat(folder, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY);
    uint8_t bytes[HEADER_BYTES];
    struct stat status;
    ssize_t size = -1;

    if (fd >= 0 && fstat(fd, &status) == 0 && S_ISREG(status.st_mode)) size = read(fd, bytes, sizeof bytes);
    if (fd >= 0) close(fd);
    return size > 0 && picture_version_parse(version, bytes, (size_t)size);
}
