// SPDX-License-Identifier: Apache-2.0
#include "tests/support/job_text.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/job/job_json.h"
#include "tests/support/folders.h"

#include <stdio.h>
#include <stdlib.h>

char *job_text_load(const char *name)
{
    char *path = xasprintf("%s/jobs/%s", PROJECT_ROOT, name);
    char *text;
    size_t length;
    struct error error = {0};

    if (!file_read_text(path, JOB_DOCUMENT_LIMIT, &text, &length, &error)) {
        fprintf(stderr, "%s\n", error.message);
        abort();
    }
    free(path);
    return text;
}

const char job_text_full[] =
    "{\"version\":1,\"name\":\"full\",\"frames\":\"1-9x2\",\"fps\":[24000,1001],\"time_offset\":0.5,"
    "\"resolution\":[64,48],"
    "\"camera\":{\"position\":{\"orbit\":{\"center\":[0,0,0],\"radius\":3,\"height\":1,\"axis\":[0,1,0],\"period\":10,"
    "\"phase_deg\":45}},"
    "\"target\":{\"keys\":[[0,[0,0,0]],[1,[0.5,0,0]]],\"interpolation\":\"smooth\"},\"up\":[0.5,1,0],"
    "\"fov\":{\"start\":40,\"rate\":0.5},\"clip\":[1,5],\"mirror\":true,\"shutter\":0},"
    "\"lights\":[{\"kind\":\"point\",\"falloff\":\"inverse_square\",\"intensity\":[10,20,30],"
    "\"position\":{\"start\":[0,3,0],\"rate\":[0.1,0,0]}},"
    "{\"kind\":\"sun\",\"intensity\":{\"lissajous\":{\"center\":3,\"amplitude\":1,\"frequency_rad\":2,\"phase_rad\":0."
    "5,"
    "\"speed\":2}},"
    "\"direction\":{\"keys\":[[0,[0,-1,0]],[2,[1,-1,0]]],\"interpolation\":\"hold\"}},"
    "{\"kind\":\"point\",\"intensity\":{\"keys\":[[0,[1,2,3]],[4,[3,2,1]]]},\"position\":[3,3,3]}],"
    "\"background\":{\"lissajous\":{\"center\":[1,1,1],\"amplitude\":[0.5,0.5,0.5],\"frequency_rad\":[1,2,3]}},"
    "\"scene\":{\"media\":[{\"density\":{\"kind\":\"fold_fractal\",\"iterations\":3,\"offset\":0.05,"
    "\"radius\":{\"keys\":[[0,0.2],[5,0.3]]},\"rotate_x_rad\":0.3,"
    "\"rotate_y_rad\":{\"lissajous\":{\"center\":0,\"amplitude\":1,\"frequency_rad\":1}},\"exponent\":1.5,"
    "\"scale\":{\"start\":5,\"rate\":1}},\"sigma_s\":[1,2,3],\"sigma_a\":{\"start\":[1,1,1],\"rate\":[0,0,0.1]},"
    "\"emission\":0.5,\"phase\":[{\"kind\":\"henyey_greenstein\",\"g\":{\"lissajous\":{\"center\":0.2,"
    "\"amplitude\":0.5,\"frequency_rad\":1}},\"weight\":0.25},{\"g\":-0.5,\"weight\":0.75}]},"
    "{\"density\":{\"kind\":\"fold_fractal\",\"iterations\":1,\"offset\":0,\"radius\":1,\"exponent\":1,\"scale\":1},"
    "\"sigma_a\":2,\"phase\":[{\"g\":0}]}]},"
    "\"quality\":{\"method\":\"midpoint\",\"step\":0.05,\"light_step\":0.1,\"min_transmittance\":0.001,\"samples\":1},"
    "\"output\":{\"path\":\"full/full.%04d.exr\",\"pixel\":\"float\",\"compression\":\"piz\",\"aovs\":[\"Z\"],"
    "\"existing\":\"fail\"},\"priority\":7,\"order\":[\"first\",\"last\",\"middle\",10,2],\"frame_limit\":90,"
    "\"pool\":\"gpu\",\"comment\":\"for the trailer\",\"tags\":[\"night\",\"shot 12\"],"
    "\"notify\":[{\"on\":[\"done\",\"missed\"],\"to\":\"chat\"},"
    "{\"on\":[\"failed\",\"waiting\"],\"webhook\":\"https://example.org/farm\"}]}";

#define OPENING                                                                                                        \
    "{\"version\":1,\"name\":\"x\",\"frames\":\"1-9x2\",\"fps\":25,\"resolution\":[64,48],\"camera\":{\"position\":["  \
    "0,0,4],"                                                                                                          \
    "\"target\":[0,0,0],\"fov\":40,\"clip\":[0,9],\"shutter\":0.5},\"output\":{\"path\":\"x.#.exr\"},"
#define POINT_LIGHT "{\"kind\":\"point\",\"intensity\":4,\"position\":[0,3,0]}"

const char job_text_noise[] = OPENING
    "\"lights\":[" POINT_LIGHT "],\"scene\":{\"media\":["
    "{\"density\":{\"kind\":\"noise\",\"frequency\":3,\"octaves\":5,\"lacunarity\":2.5,\"H\":0.75,\"bias\":-0.25,"
    "\"mode\":\"clip\",\"offset\":{\"start\":[1,2,3],\"rate\":[0,0,0.5]},\"rotate\":{\"axis\":[1,1,0],"
    "\"angle\":{\"start\":-3,\"rate\":3}},\"scale\":6,"
    "\"bounds\":{\"kind\":\"sphere\",\"center\":{\"orbit\":{\"radius\":1,\"period\":9}},\"radius\":1.5,\"falloff\":0."
    "25}},"
    "\"sigma_s\":[1,2,3],\"phase\":[{\"kind\":\"rayleigh\",\"weight\":0.75},{\"g\":0.5,\"weight\":0.25}]},"
    "{\"density\":{\"kind\":\"noise\",\"frequency\":{\"start\":1,\"rate\":1},\"mode\":\"absolute\",\"bounds\":"
    "{\"kind\":\"box\",\"center\":[1,0,0],\"size\":[1,2,3],\"falloff\":0}},\"sigma_a\":2}]},"
    "\"quality\":{\"method\":\"midpoint\",\"step\":0.05,\"light_step\":0.1,\"roulette\":{\"below\":0.125,\"survive\":0."
    "5},"
    "\"samples\":4,\"pixels\":{\"stride\":8,\"threshold\":0.01}}}";

const char job_text_fog[] =
    OPENING "\"lights\":[" POINT_LIGHT "],\"scene\":{\"media\":["
            "{\"density\":{\"kind\":\"homogeneous\",\"scale\":{\"keys\":[[0,0.5],[1,2]]},\"bounds\":{\"kind\":\"slab\","
            "\"center\":[0,-1,0],"
            "\"normal\":[0.5,2,0],\"thickness\":2,\"falloff\":0}},\"sigma_s\":1,\"phase\":[{\"kind\":\"rayleigh\"}]},"
            "{\"density\":{\"kind\":\"homogeneous\"},\"sigma_a\":0.25}]},"
            "\"quality\":{\"method\":\"equiangular\",\"points\":8,\"samples\":2}}";

const char job_text_grid[] = OPENING
    "\"lights\":[" POINT_LIGHT "],\"scene\":{\"media\":["
    "{\"density\":{\"kind\":\"grid\",\"file\":\"/data/"
    "head.raw\",\"size\":[64,32,16],\"type\":\"int16\",\"byte_order\":\"big\","
    "\"skip_bytes\":7,\"spacing\":[0.01,0.02,0.03],\"interpolation\":\"nearest\",\"center\":{\"start\":[0,0,1],"
    "\"rate\":[1,0,0]},\"transfer_function\":[[-1,0,0,0,0],[0.25,1,2,3,0.5],[2,3,2,1,0.999999]],"
    "\"unit_distance\":{\"start\":0.01,\"rate\":1},\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}},"
    "{\"density\":{\"kind\":\"grid\",\"file\":\"/data/"
    "smoke.####.nvdb\",\"grid\":\"density\",\"scale\":3},\"sigma_s\":1,"
    "\"blackbody\":{\"grid\":\"temperature\",\"kelvin\":{\"start\":1500,\"rate\":1},\"intensity\":2}},"
    "{\"density\":{\"kind\":\"grid\",\"file\":\"still.nvdb\"},\"blackbody\":{\"grid\":\"flame\",\"kelvin\":1}}]},"
    "\"quality\":{\"method\":\"midpoint\",\"step_voxels\":0.5,\"light_step_voxels\":2}}";

const char job_text_glsl[] = OPENING
    "\"scene\":{\"media\":["
    "{\"density\":{\"kind\":\"glsl\",\"file\":\"/data/custom.glsl\",\"source\":\"float density(vec3 p, float t)\\n{\\n "
    "   return "
    "0.5 - "
    "length(p);\\n}\\n\",\"lipschitz\":1,\"majorant\":4,\"scale\":2,\"bounds\":{\"kind\":\"sphere\",\"radius\":1}},"
    "\"sigma_a\":1},"
    "{\"density\":{\"kind\":\"glsl\",\"file\":\"a.glsl\",\"bounds\":{\"kind\":\"slab\",\"thickness\":2}},\"sigma_a\":1}"
    "]},"
    "\"quality\":{\"method\":\"midpoint\",\"step\":0.5}}";

const char job_text_paths[] = OPENING
    "\"lights\":["
    "{\"kind\":\"spot\",\"intensity\":[1,2,3],\"position\":{\"orbit\":{\"radius\":2,\"period\":9}},\"direction\":[0,-2,"
    "0],\"inner\":{\"start\":10,\"rate\":1},\"outer\":{\"keys\":[[0,30],[1,40]]}},"
    "{\"kind\":\"sphere\",\"intensity\":4,\"position\":[0,3,0],\"radius\":{\"start\":0.25,\"rate\":0.125}},"
    "{\"kind\":\"dome\",\"file\":\"/data/noon.exr\",\"scale\":[1,0.5,0.25],\"rotate\":{\"axis\":[0,1,0.5],\"angle\":{"
    "\"start\":30,\"rate\":5}},\"visible\":true}],"
    "\"scene\":{\"scattering\":{\"orders\":8},\"media\":["
    "{\"density\":{\"kind\":\"noise\",\"frequency\":2,\"bounds\":{\"kind\":\"sphere\",\"radius\":1}},\"sigma_s\":1}]},"
    "\"quality\":{\"method\":\"paths\",\"paths\":64,\"samples\":2}}";

const char job_text_objects[] = OPENING
    "\"lights\":[" POINT_LIGHT "],\"scene\":{\"media\":["
    "{\"density\":{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"radius\":2}},\"sigma_s\":1}],"
    "\"objects\":["
    "{\"kind\":\"plane\",\"point\":[0,-1,0],\"normal\":[0.5,2,0],\"material\":{\"kind\":\"diffuse\",\"albedo\":[0.5,"
    "0.75,1],"
    "\"texture\":{\"file\":\"/data/tiles.PNG\",\"size\":[2,0.5],\"filter\":\"nearest\",\"color_space\":\"linear\"},"
    "\"specular\":{\"keys\":[[0,0.5],[1,1]]},\"fresnel\":\"schlick\",\"ior\":1.25,\"f0\":0.125,\"f90\":0.75,"
    "\"roughness\":0.25}},"
    "{\"kind\":\"sphere\",\"center\":{\"orbit\":{\"radius\":1,\"period\":9}},\"radius\":{\"start\":1,\"rate\":0.5},"
    "\"material\":{\"kind\":\"dielectric\",\"ior\":{\"start\":1.5,\"rate\":0.5},\"fresnel\":\"schlick\",\"f90\":0.5,"
    "\"roughness\":0.125,\"interior\":{\"sigma_a\":[0.75,0.125,0.25]}}},"
    "{\"kind\":\"box\",\"center\":[2,0,0],\"size\":[1,2,3],\"material\":{\"kind\":\"mirror\",\"reflectance\":[1,0.5,"
    "0.25],"
    "\"roughness\":0.5}},"
    "{\"kind\":\"sphere\",\"center\":[-2,0,0],\"radius\":0.5,\"material\":{\"kind\":\"diffuse\",\"texture\":{\"file\":"
    "\"globe.png\"}}},"
    "{\"kind\":\"union\",\"of\":[{\"kind\":\"sphere\",\"center\":[0,3,0],\"radius\":0.5},{\"kind\":\"box\",\"center\":"
    "[0,4,0],"
    "\"size\":[1,1,1]},{\"kind\":\"plane\",\"point\":[0,-9,0]}],\"material\":{\"kind\":\"diffuse\",\"albedo\":0.5,"
    "\"texture\":{\"file\":\"wood.exr\",\"size\":0.25,\"filter\":\"linear\"},\"specular\":0.5,\"fresnel\":\"none\"}},"
    "{\"kind\":\"sphere\",\"center\":[0,0,-4],\"radius\":1,\"material\":{\"kind\":\"dielectric\",\"ior\":1.25,"
    "\"interior\":{\"sigma_s\":1,\"density\":{\"kind\":\"noise\",\"frequency\":2}}}}]},"
    "\"quality\":{\"method\":\"midpoint\",\"step\":0.05,\"light_step\":0.1,\"max_depth\":3,\"min_throughput\":0.0625,"
    "\"max_cut\":0.25}}";
