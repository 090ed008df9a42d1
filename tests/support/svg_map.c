// SPDX-License-Identifier: Apache-2.0
#include "tests/support/svg_map.h"

#include <stdio.h>

void svg_map_begin(int width_px, int height_px)
{
    printf("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" height=\"%d\" "
           "font-family=\"sans-serif\" font-size=\"11\">\n<style>\n"
           "text { fill: #222 } .title { font-weight: bold; font-size: 12px } .cell { fill: #111; font-size: 10px }\n"
           ".good { fill: #8fd18f } .fair { fill: #f0cd6a } .bad { fill: #ee8a80 } .refused { fill: #c8ccd0 }\n"
           "@media (prefers-color-scheme: dark) { text { fill: #ddd } .cell { fill: #111 } .good { fill: #5fae66 } "
           ".fair { fill: #cfa63c } .bad { fill: #d0665c } .refused { fill: #8a9096 } }\n</style>\n",
           width_px, height_px, width_px, height_px);
}
