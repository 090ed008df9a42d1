// SPDX-License-Identifier: Apache-2.0
#include "worker/textures/gl_caches.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/gl/gl_functions.h"
#include "worker/gl/gl_program.h"
#include "worker/gl/gl_programs.h"
#include "worker/gl/lru.h"
#include "worker/volume/volume_memory.h"

#include <stdlib.h>
#include <string.h>

enum {
    KEPT_LIMIT = 2 * SCENE_CACHE_LIMIT, // twice as many as a pass has: one is empty or idle
    FIRST_STRIP_ROWS = 4,
    STRIP_GROWTH_LIMIT = 8
};
_Static_assert((int)KEPT_LIMIT <= (int)LRU_LIMIT, "all textures of two passes are kept");

static const double strip_seconds = 0.2;
// Limits the textures that the pass does not need but a later one may.
static const size_t idle_bytes_limit = (size_t)1 << 28;

static const GLenum internal_formats[] = {
    [SCENE_CACHE_R32F] = GL_R32F, [SCENE_CACHE_RG32F] = GL_RG32F, [SCENE_CACHE_RGBA32F] = GL_RGBA32F};

struct gl_caches {
    const struct gl_functions *gl; // borrowed; outlives us
    struct gl_programs *programs;  // borrowed; outlives us
    unsigned uniform_buffer, turns_buffer;
    unsigned sums_buffer; // of the cache that was filled last, if it has sums
    struct lru lru;       // keyed by the hash of all that the values depend on; a moment is one binding
    unsigned textures[KEPT_LIMIT];
    int64_t fill_count;
    struct scene_cache_walks walked;
};

struct gl_caches *gl_caches_create(const struct gl_functions *gl, struct gl_programs *programs)
{
    struct gl_caches *caches = xcalloc(1, sizeof *caches);

    caches->gl = gl;
    caches->programs = programs;
    caches->lru = (struct lru){.capacity = KEPT_LIMIT, .idle_bytes_limit = idle_bytes_limit};
    gl->CreateBuffers(1, &caches->uniform_buffer);
    gl->CreateBuffers(1, &caches->turns_buffer);
    return caches;
}

static void drop_sums(struct gl_caches *caches)
{
    if (caches->sums_buffer) caches->gl->DeleteBuffers(1, &caches->sums_buffer);
    caches->sums_buffer = 0;
}

static void drop(void *user, int index)
{
    struct gl_caches *caches = user;

    caches->gl->DeleteTextures(1, &caches->textures[index]);
}

void gl_caches_clear(struct gl_caches *caches)
{
    lru_clear(&caches->lru, drop, caches);
}

void gl_caches_destroy(struct gl_caches *caches)
{
    if (!caches) return;
    gl_caches_clear(caches);
    caches->gl->DeleteBuffers(1, &caches->uniform_buffer);
    caches->gl->DeleteBuffers(1, &caches->turns_buffer);
    drop_sums(caches);
    free(caches);
}

int64_t gl_caches_count_fills(const struct gl_caches *caches)
{
    return caches->fill_count;
}

struct scene_cache_walks gl_caches_count_walks(const struct gl_caches *caches)
{
    return caches->walked;
}

// Hashes all that the cache's values depend on into its key; `keys` has those of the caches before it.
static void find_key(const struct gl_caches_request *request, size_t i, char (*keys)[HASH_TEXT_SIZE])
{
    const struct scene_cache *cache = &request->caches[i];
    char own[HASH_TEXT_SIZE];
    char *bytes = NULL;
    size_t length = 0;
    FILE *text = open_memstream(&bytes, &length);

    if (!text) abort();
    scene_cache_hash(cache, own);
    fprintf(text, "%s files %s", own, cache->reads_files ? request->files_hash : "");
    for (size_t k = 0; k < i; ++k)
        if (cache->reads >> k & 1) fprintf(text, " %s", keys[k]);
    if (cache->uniforms.size_bytes > 0) fwrite(request->blocks[i], 1, cache->uniforms.size_bytes, text);
    if (fclose(text) != 0) abort();
    hash_bytes(bytes, length, keys[i]);
    free(bytes);
}

static void set_sampling(const struct gl_functions *gl, unsigned texture)
{
    gl->TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl->TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->TextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl->TextureParameteri(texture, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
}

static bool make_texture(const struct gl_functions *gl, const struct scene_cache *cache, unsigned *texture,
                         struct error *error)
{
    const int *size = cache->size;
    GLint side_limit = 0;

    gl->GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &side_limit);
    if (size[0] > side_limit || size[1] > side_limit || size[2] > side_limit) {
        error_set(error, "GL here takes grids of at most %d texels a side, got %d x %d x %d", side_limit, size[0],
                  size[1], size[2]);
        return false;
    }
    gl->CreateTextures(GL_TEXTURE_3D, 1, texture);
    gl->TextureStorage3D(*texture, 1, internal_formats[cache->format], size[0], size[1], size[2]);
    if (gl->GetError() == GL_OUT_OF_MEMORY) {
        error_set(error, "GL here has no room for a grid of %d x %d x %d texels (%.2f GiB)", size[0], size[1], size[2],
                  (double)scene_cache_size_bytes(cache) / (1 << 30));
        gl->DeleteTextures(1, texture);
        return false;
    }
    set_sampling(gl, *texture);
    if (cache->takes_turns) gl->ClearTexImage(*texture, 0, GL_RGBA, GL_FLOAT, NULL);
    return true;
}

static int next_rows(int rows, double seconds, int most)
{
    double factor = strip_seconds / (seconds > 1e-6 ? seconds : 1e-6);
    int next = (int)(rows * (factor < STRIP_GROWTH_LIMIT ? factor : STRIP_GROWTH_LIMIT));

    if (next < 1) next = 1;
    return next < most ? next : most;
}

static void bind_turn(const struct gl_caches *caches, const GLuint *state, size_t size_bytes)
{
    caches->gl->NamedBufferData(caches->turns_buffer, (GLsizeiptr)size_bytes, state, GL_DYNAMIC_READ);
    caches->gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, caches->turns_buffer);
}

static void read_turn(const struct gl_caches *caches, GLuint *state, size_t size_bytes)
{
    caches->gl->MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    caches->gl->GetNamedBufferSubData(caches->turns_buffer, 0, (GLsizeiptr)size_bytes, state);
}

static void begin_turn(const struct gl_caches *caches, const struct scene_cache *cache)
{
    static const GLuint none = 0;

    if (cache->takes_turns) bind_turn(caches, &none, sizeof none);
}

// Returns true when the strip has to run again.
static bool has_another_turn(const struct gl_caches *caches, const struct scene_cache *cache)
{
    GLuint is_unfinished = 0;

    if (!cache->takes_turns) return false;
    read_turn(caches, &is_unfinished, sizeof is_unfinished);
    return is_unfinished != 0;
}

// Runs the program strip by strip, so that a long run can be stopped. A strip is some layers, or some rows of groups
// where there is one layer.
static bool run_strips(const struct gl_caches *caches, struct kept_program *program, const struct scene_cache *cache,
                       const struct gl_caches_request *request)
{
    const struct gl_functions *gl = caches->gl;
    const int *count = cache->invocations;
    int columns = (count[0] + SCENE_CACHE_GROUP_SIDE - 1) / SCENE_CACHE_GROUP_SIDE;
    int rows = (count[1] + SCENE_CACHE_GROUP_SIDE - 1) / SCENE_CACHE_GROUP_SIDE;
    bool has_layers = count[2] > 1;
    int most = has_layers ? count[2] : rows;

    if (program->rows == 0) program->rows = FIRST_STRIP_ROWS;
    gl->ProgramUniform3i(program->name, 1, count[0], count[1], count[2]);
    for (int first = 0; first < most;) {
        int strip = program->rows < most - first ? program->rows : most - first;
        double start = clock_now_s();

        begin_turn(caches, cache);
        gl->ProgramUniform3i(program->name, 0, 0, has_layers ? 0 : first * SCENE_CACHE_GROUP_SIDE,
                             has_layers ? first : 0);
        gl->DispatchCompute((GLuint)columns, (GLuint)(has_layers ? rows : strip), (GLuint)(has_layers ? strip : 1));
        gl->Finish();
        if (!has_another_turn(caches, cache)) first += strip;
        program->rows = next_rows(program->rows, clock_now_s() - start, most);
        if (request->on_strip && !request->on_strip(request->user)) return false;
    }
    return true;
}

// Runs the program turn by turn, over parts that its invocations take. Parts below `first` are done.
static bool run_parts(const struct gl_caches *caches, struct kept_program *program, const struct scene_cache *cache,
                      const struct gl_caches_request *request)
{
    const struct gl_functions *gl = caches->gl;
    int most = cache->invocations[1] / SCENE_CACHE_GROUP_SIDE;
    GLuint first = 0;

    if (program->rows == 0) program->rows = FIRST_STRIP_ROWS;
    while (first < cache->part_count) {
        GLuint state[2] = {first, UINT32_MAX}; // the next part, and the first that is left
        double start = clock_now_s();

        bind_turn(caches, state, sizeof state);
        gl->DispatchCompute(1, (GLuint)program->rows, 1);
        gl->Finish();
        read_turn(caches, state, sizeof state);
        if (state[0] == first) break; // nothing ran: GL is lost, which whoever draws with it finds out
        first = state[0] < state[1] ? state[0] : state[1];
        // The last turns, in which some find nothing to do, say little.
        if (state[0] < cache->part_count) program->rows = next_rows(program->rows, clock_now_s() - start, most);
        if (request->on_strip && !request->on_strip(request->user)) return false;
    }
    return true;
}

// Makes the sums of a cache anew.
static bool begin_sums(struct gl_caches *caches, const struct scene_cache *cache, struct error *error)
{
    const struct gl_functions *gl = caches->gl;

    if (cache->reads_sums) return true;
    drop_sums(caches);
    if (cache->sum_count == 0) return true;
    gl->CreateBuffers(1, &caches->sums_buffer);
    gl->NamedBufferStorage(caches->sums_buffer, (GLsizeiptr)(cache->sum_count * sizeof(uint32_t)), NULL, 0);
    if (gl->GetError() == GL_OUT_OF_MEMORY) {
        error_set(error, "GL here has no room for %zu sums of a grid", cache->sum_count);
        drop_sums(caches);
        return false;
    }
    gl->ClearNamedBufferData(caches->sums_buffer, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, caches->sums_buffer);
    return true;
}

static void count_walks(struct gl_caches *caches, const struct scene_cache *cache)
{
    GLuint counts[2] = {0};

    caches->gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    caches->gl->GetNamedBufferSubData(caches->sums_buffer, (GLintptr)((cache->sum_count - 2) * sizeof *counts),
                                      sizeof counts, counts);
    caches->walked.walks += counts[0];
    caches->walked.steps += (double)SCENE_CACHE_STEPS * counts[1];
}

static bool fill(struct gl_caches *caches, struct kept_program *program, const struct gl_caches_request *request,
                 size_t i, unsigned texture)
{
    const struct gl_functions *gl = caches->gl;
    const struct scene_cache *cache = &request->caches[i];

    gl->UseProgram(program->name);
    if (cache->uniforms.size_bytes > 0) {
        gl->NamedBufferData(caches->uniform_buffer, (GLsizeiptr)cache->uniforms.size_bytes, request->blocks[i],
                            GL_STREAM_DRAW);
        gl->BindBufferBase(GL_UNIFORM_BUFFER, 0, caches->uniform_buffer);
    }
    gl->BindImageTexture(0, texture, 0, GL_TRUE, 0, cache->takes_turns ? GL_READ_WRITE : GL_WRITE_ONLY,
                         internal_formats[cache->format]);
    if (!(cache->part_count > 0 ? run_parts : run_strips)(caches, program, cache, request)) return false;
    gl->MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    if (cache->counts_walks) count_walks(caches, cache);
    caches->fill_count++;
    return true;
}

// All textures of a pass are in GL at once, the intermediate ones included.
static bool check_memory(const struct gl_caches_request *request, struct error *error)
{
    int64_t size_bytes = 0;

    for (size_t i = 0; i < request->count; ++i)
        size_bytes += (int64_t)scene_cache_size_bytes(&request->caches[i]);
    if (volume_memory_check(size_bytes, volume_memory_limit(), error)) return true;
    error_prefix(error, "quality: the grids of a frame");
    return false;
}

static enum gl_caches_end make(struct gl_caches *caches, const struct gl_caches_request *request, size_t i,
                               const char *key, int *index, struct error *error)
{
    const struct scene_cache *cache = &request->caches[i];
    size_t size_bytes = scene_cache_size_bytes(cache);
    double start = clock_now_s();
    struct kept_program *program = gl_programs_find(caches->programs, cache->hash,
                                                    &(struct gl_program_params){.compute = cache->text,
                                                                                .module_names = cache->module_names,
                                                                                .module_count = cache->module_count},
                                                    error);
    unsigned texture;

    if (!program || !check_memory(request, error)) return GL_CACHES_REFUSED;
    *index = lru_make_room(&caches->lru, size_bytes, drop, caches);
    if (!begin_sums(caches, cache, error) || !make_texture(caches->gl, cache, &texture, error))
        return GL_CACHES_REFUSED;
    if (!fill(caches, program, request, i, texture)) {
        caches->gl->DeleteTextures(1, &texture);
        return GL_CACHES_STOPPED;
    }
    caches->textures[*index] = texture;
    lru_put(&caches->lru, *index, key, size_bytes);
    log_debug("caches: %s, %d x %d x %d texels, filled in %.1f ms", cache->name, cache->size[0], cache->size[1],
              cache->size[2], 1000 * (clock_now_s() - start));
    return GL_CACHES_BOUND;
}

// Returns which caches have to be there, one bit each. An intermediate cache is wanted only while a wanted cache that
// reads it has to be filled.
static uint64_t find_wanted(struct gl_caches *caches, const struct gl_caches_request *request,
                            char (*keys)[HASH_TEXT_SIZE])
{
    uint64_t wanted = 0, filled = 0;

    for (size_t i = request->count; i-- > 0;) {
        uint64_t bit = (uint64_t)1 << i;
        bool is_there = lru_find(&caches->lru, keys[i]) >= 0;

        for (size_t k = i + 1; k < request->count; ++k)
            if (filled >> k & 1 && request->caches[k].reads & bit) wanted |= bit;
        if (!request->caches[i].is_step) wanted |= bit;
        if (wanted & bit && !is_there) filled |= bit;
    }
    return wanted;
}

static void drop_steps(struct gl_caches *caches, const struct gl_caches_request *request, char (*keys)[HASH_TEXT_SIZE])
{
    for (size_t i = 0; i < request->count; ++i) {
        int index = request->caches[i].is_step ? lru_find(&caches->lru, keys[i]) : -1;

        if (index >= 0) lru_remove(&caches->lru, index, drop, caches);
    }
}

static enum gl_caches_end bind_wanted(struct gl_caches *caches, const struct gl_caches_request *request,
                                      char (*keys)[HASH_TEXT_SIZE], struct error *error)
{
    uint64_t wanted = find_wanted(caches, request, keys);

    for (size_t i = 0; i < request->count; ++i) {
        int index = lru_find(&caches->lru, keys[i]);
        enum gl_caches_end end;

        if (!(wanted >> i & 1)) continue;
        end = index >= 0 ? GL_CACHES_BOUND : make(caches, request, i, keys[i], &index, error);
        if (end != GL_CACHES_BOUND) return end;
        caches->gl->BindTextureUnit(request->caches[i].unit, caches->textures[index]);
    }
    return GL_CACHES_BOUND;
}

enum gl_caches_end gl_caches_bind(struct gl_caches *caches, const struct gl_caches_request *request,
                                  struct error *error)
{
    char keys[SCENE_CACHE_LIMIT][HASH_TEXT_SIZE];
    enum gl_caches_end end;

    lru_begin(&caches->lru);
    for (size_t i = 0; i < request->count; ++i) {
        find_key(request, i, keys);
        (void)lru_find(&caches->lru, keys[i]);
    }
    end = bind_wanted(caches, request, keys, error);
    drop_sums(caches);
    drop_steps(caches, request, keys);
    return end;
}
