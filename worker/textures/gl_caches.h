// The textures of scene caches: filled by their programs when needed, kept while what they depend on stays the same.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/glsl/scene_cache.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct gl_caches;
struct gl_functions;
struct gl_programs;

// `gl` and `programs` outlive the caches.
struct gl_caches *gl_caches_create(const struct gl_functions *gl, struct gl_programs *programs);
void gl_caches_destroy(struct gl_caches *caches); // accepts NULL
void gl_caches_clear(struct gl_caches *caches);   // drops all textures, whose contents are in doubt

enum gl_caches_end {
    GL_CACHES_BOUND,
    GL_CACHES_STOPPED, // on_strip asked for it
    GL_CACHES_REFUSED  // a program does not compile, or there is no room; see `error`
};

// Called after each strip of the work. Returning false stops the rest.
typedef bool gl_caches_progress(void *user);

struct gl_caches_request {
    const struct scene_cache *caches; // SCENE_CACHE_LIMIT at most, each after those that it reads
    size_t count;
    const unsigned char *const *blocks; // the packed uniforms of each; NULL where it has none
    const char *files_hash;             // the hash of the frame's files, "" for none
    gl_caches_progress *on_strip;       // may be NULL
    void *user;
};

// Fills the caches that are not kept, then binds each texture to its unit. The caller has bound the files that caches
// read. Changes the program in use and the uniform buffer bound to 0. The caller checks GL's errors.
enum gl_caches_end gl_caches_bind(struct gl_caches *caches, const struct gl_caches_request *request,
                                  struct error *error);
int64_t gl_caches_count_fills(const struct gl_caches *caches);                  // fills since gl_caches_create
struct scene_cache_walks gl_caches_count_walks(const struct gl_caches *caches); // since then, of caches that count them
