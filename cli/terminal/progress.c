// SPDX-License-Identifier: Apache-2.0
#include "cli/terminal/progress.h"

#include "cli/terminal/table.h"
#include "core/base/alloc.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

enum {
    LIVE_INTERVAL_MS = 100,
    PLAIN_INTERVAL_MS = 5000,
    BAR_MIN = 8,
    BAR_MAX = 40,
    FACTS_MIN = 7, // columns; with less room for the facts there is no bar
    LABEL_MAX = 24,
    WIDTH_UNKNOWN = 100,
    PLAIN_WIDTH = 1000
};

char *progress_format_duration(double seconds)
{
    int64_t whole = seconds < 1e15 ? (int64_t)(seconds + 0.5) : (int64_t)1e15;

    if (seconds < 9.95) return xasprintf("%.1f s", seconds);
    if (seconds < 59.5) return xasprintf("%" PRId64 " s", whole);
    if (whole < 3600) return xasprintf("%" PRId64 ":%02d", whole / 60, (int)(whole % 60));
    if (whole < 86400)
        return xasprintf("%" PRId64 ":%02d:%02d", whole / 3600, (int)(whole / 60 % 60), (int)(whole % 60));
    return xasprintf("%" PRId64 " d %02d:%02d", whole / 86400, (int)(whole / 3600 % 24), (int)(whole / 60 % 60));
}

char *progress_format_pace(double seconds_per_frame)
{
    if (seconds_per_frame < 0.001) return xstrdup("<0.001");
    return xasprintf(seconds_per_frame < 999.5 ? "%.3g" : "%.0f", seconds_per_frame);
}

char *progress_format_state(const char *state, const char *reason)
{
    if (!reason) return xstrdup(state);
    if (strncmp(reason, state, strlen(state)) == 0) return xstrdup(reason);
    return xasprintf("%s: %s", state, reason);
}

// Cuts `text` to `width` columns at a code point and replaces control bytes.
static void fit_text(char *text, int width)
{
    int columns = 0;

    for (char *byte = text; *byte; byte++) {
        if ((unsigned char)*byte < 0x20 || *byte == 0x7f) *byte = '?';
        if (((unsigned char)*byte & 0xc0) != 0x80 && ++columns > width) {
            *byte = 0;
            return;
        }
    }
}

static bool is_running(const struct progress *progress)
{
    return !progress->state || strcmp(progress->state, "running") == 0;
}

static char *format_facts(const struct progress *progress)
{
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);

    if (!out) abort();
    fprintf(out, "%" PRId64 "/%" PRId64, progress->done, progress->total);
    if (progress->failed > 0) fprintf(out, "  %" PRId64 " failed", progress->failed);
    if (progress->seconds_per_frame >= 0) {
        char *pace = progress_format_pace(progress->seconds_per_frame);

        fprintf(out, "  %s s/frame", pace);
        free(pace);
    }
    if (progress->eta_s >= 0 && is_running(progress)) {
        char *eta = progress_format_duration(progress->eta_s);

        fprintf(out, "  ETA %s", eta);
        free(eta);
    }
    if (progress->phase && is_running(progress)) {
        fprintf(out, "  %s", progress->phase);
        if (progress->phase_progress > 0) fprintf(out, " %.0f %%", 100 * progress->phase_progress);
    }
    if (!is_running(progress)) {
        char *state = progress_format_state(progress->state, progress->reason);

        fprintf(out, "  %s", state);
        free(state);
    } else if (progress->reason) {
        fprintf(out, ": %s", progress->reason);
    }
    fclose(out);
    return text;
}

static void write_bar(FILE *out, const struct progress *progress, int width, bool has_color)
{
    double total = progress->total > 0 ? (double)progress->total : 1;
    int done = (int)((double)progress->done / total * width);
    int failed = (int)((double)(progress->done + progress->failed) / total * width) - done;

    if (progress->failed > 0 && failed == 0 && done < width) failed = 1;
    fputc('[', out);
    if (has_color) fputs("\033[32m", out);
    for (int i = 0; i < done; i++)
        fputc('=', out);
    if (has_color) fputs("\033[31m", out);
    for (int i = 0; i < failed; i++)
        fputc('x', out);
    if (has_color) fputs("\033[0m", out);
    for (int i = done + failed; i < width; i++)
        fputc(' ', out);
    fputc(']', out);
}

char *progress_format(const struct progress *progress, int width, bool has_color)
{
    char *label = xstrdup(progress->label ? progress->label : "");
    char *facts = format_facts(progress);
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);
    int room, bar, facts_width = (int)table_text_width(facts);

    if (!out) abort();
    fit_text(label, LABEL_MAX < width ? LABEL_MAX : width);
    room = width - (int)table_text_width(label) - 2; // after the label and its gap
    bar = room - facts_width - 4;                    // two brackets, two spaces
    if (bar > BAR_MAX) bar = BAR_MAX;
    if (bar < BAR_MIN) bar = BAR_MIN;
    fputs(label, out);
    if (room >= bar + 4 + (facts_width < FACTS_MIN ? facts_width : FACTS_MIN)) {
        fputs("  ", out);
        write_bar(out, progress, bar, has_color);
        room -= bar + 2;
    }
    if (room > 2) {
        fit_text(facts, room - 2);
        fprintf(out, "  %s", facts);
    }
    fclose(out);
    free(label);
    free(facts);
    return text;
}

void progress_display_init(struct progress_display *display, FILE *out)
{
    const char *terminal = getenv("TERM"), *no_color = getenv("NO_COLOR");

    memset(display, 0, sizeof *display);
    display->out = out;
    display->is_live = isatty(fileno(out)) && terminal && *terminal && strcmp(terminal, "dumb") != 0;
    display->has_color = display->is_live && !(no_color && *no_color);
}

static int terminal_width(const struct progress_display *display)
{
    struct winsize size = {0};

    if (ioctl(fileno(display->out), TIOCGWINSZ, &size) != 0 || size.ws_col < 20) return WIDTH_UNKNOWN;
    return size.ws_col - 1;
}

static uint64_t hash_text(uint64_t hash, const char *text)
{
    for (; *text; text++)
        hash = (hash ^ (unsigned char)*text) * 1099511628211u;
    return hash;
}

// Of the jobs that are held, and why.
static uint64_t hash_held(const struct progress *jobs, size_t count)
{
    uint64_t hash = 0;

    for (size_t i = 0; i < count; i++) {
        if (!jobs[i].state || strcmp(jobs[i].state, "paused") != 0) continue;
        hash = hash_text(hash + i + 1, jobs[i].reason ? jobs[i].reason : "");
    }
    return hash;
}

static void draw_plain(struct progress_display *display, const struct progress *jobs, size_t count)
{
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);
    uint64_t hash;

    if (!out) abort();
    for (size_t i = 0; i < count; i++) {
        char *facts = format_facts(&jobs[i]);
        char *label = xstrdup(jobs[i].label ? jobs[i].label : "");

        fit_text(facts, PLAIN_WIDTH);
        fit_text(label, PLAIN_WIDTH);
        fprintf(out, "%s: %s\n", label, facts);
        free(facts);
        free(label);
    }
    fclose(out);
    hash = hash_text(14695981039346656037u, text);
    if (hash != display->last_hash) fputs(text, display->out);
    display->last_hash = hash;
    free(text);
}

void progress_display_draw(struct progress_display *display, const struct progress *jobs, size_t count, int64_t now_ms,
                           bool is_final)
{
    uint64_t held_hash = hash_held(jobs, count);
    int width;

    if (!is_final && now_ms < display->next_ms && held_hash == display->held_hash) return;
    display->held_hash = held_hash;
    display->next_ms = now_ms + (display->is_live ? LIVE_INTERVAL_MS : PLAIN_INTERVAL_MS);
    if (!display->is_live) {
        draw_plain(display, jobs, count);
        fflush(display->out);
        return;
    }
    width = terminal_width(display);
    progress_display_clear(display);
    for (size_t i = 0; i < count; i++) {
        char *line = progress_format(&jobs[i], width, display->has_color);

        fprintf(display->out, "%s\n", line);
        free(line);
    }
    display->lines = (int)count;
    fflush(display->out);
}

void progress_display_clear(struct progress_display *display)
{
    if (display->lines > 0) fprintf(display->out, "\033[%dA\r\033[J", display->lines);
    display->lines = 0;
}

int64_t progress_now_ms(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}
