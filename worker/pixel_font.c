#include "worker/pixel_font.h"

#include <stdbool.h>
#include <string.h>

static const char characters[] = "0123456789.-s";

// A row a byte, its leftmost pixel in bit 4.
static const unsigned char glyphs[][PIXEL_FONT_HEIGHT] = {
    {0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e}, {0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e},
    {0x0e, 0x11, 0x01, 0x02, 0x04, 0x08, 0x1f}, {0x1f, 0x02, 0x04, 0x02, 0x01, 0x11, 0x0e},
    {0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02}, {0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e},
    {0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e}, {0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08},
    {0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e}, {0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c},
    {0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x0c}, {0x00, 0x00, 0x00, 0x1f, 0x00, 0x00, 0x00},
    {0x00, 0x00, 0x0e, 0x10, 0x0e, 0x01, 0x1e},
};

// A pixel of margin around each character.
enum { ADVANCE = PIXEL_FONT_WIDTH + 1 };

static int box_width(const char *text, int scale)
{
    return ((int)strlen(text) * ADVANCE + 1) * scale;
}

int pixel_font_height(int scale)
{
    return (PIXEL_FONT_HEIGHT + 2) * scale;
}

// Column and row count from the box's corner.
static bool is_set(const char *text, int column, int row)
{
    int index = (column - 1) / ADVANCE, x = (column - 1) % ADVANCE, y = row - 1;
    const char *found;

    if (column < 1 || x >= PIXEL_FONT_WIDTH || y < 0 || y >= PIXEL_FONT_HEIGHT) return false;
    found = strchr(characters, text[index]);
    return found && *found && (glyphs[found - characters][y] >> (PIXEL_FONT_WIDTH - 1 - x) & 1);
}

void pixel_font_draw(unsigned char *rgb, int width_px, int height_px, int x, int y, int scale, const char *text)
{
    int width = box_width(text, scale), height = pixel_font_height(scale);

    for (int j = 0; j < height && y + j < height_px; j++)
        for (int i = 0; i < width && x + i < width_px; i++) {
            if (x + i < 0 || y + j < 0) continue;
            memset(rgb + ((size_t)(y + j) * (size_t)width_px + (size_t)(x + i)) * 3,
                   is_set(text, i / scale, j / scale) ? 255 : 0, 3);
        }
}
