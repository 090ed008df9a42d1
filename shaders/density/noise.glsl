// Perlin's improved noise: a lattice of period 256 with one of twelve gradients at each point, by his own permutation.
// Perlin, Improving Noise, SIGGRAPH 2002.

// Word i holds what a lattice point and the one beyond it need, the two being i and i + 1 in the permutation. Bits 0 to
// 7: the permutation's number i, 8 to 15: its number i + 1. Bits 31 to 26 and 25 to 20: their gradients, two bits for
// each of x, y and z, which are the two highest bits of the floats 2, -2 and 0. Seven reads of one table are the least
// for a point without larger tables, and software GL reads an array of constants faster than any texture.
const uint DENSITY_NOISE_TABLE[256] = uint[256](
    0xcd40a097u, 0x50d089a0u, 0x34f05b89u, 0x3c705a5bu, 0x1cf00f5au, 0x3fc0830fu, 0xf0d00d83u, 0x34d0c90du,
    0x34f05fc9u, 0x3d40605fu, 0x53103560u, 0xc5c0c235u, 0x70d0e9c2u, 0x373007e9u, 0xcf40e107u, 0xd1408ce1u,
    0x5110248cu, 0x47306724u, 0xcf401e67u, 0xd310451eu, 0xc7408e45u, 0xd050088eu, 0x17c06308u, 0xf3102563u,
    0xc540f025u, 0x531015f0u, 0xc4700a15u, 0x1f30170au, 0xcf40be17u, 0xd13006beu, 0x4d109406u, 0x4730f794u,
    0xcc5078f7u, 0x1470ea78u, 0x1cf04beau, 0x3d40004bu, 0x50701a00u, 0x1f10c51au, 0xc7403ec5u, 0xd3405e3eu,
    0xd140fc5eu, 0x50f0dbfcu, 0x3cf0cbdbu, 0x3f1075cbu, 0xc7c02375u, 0xf0f00b23u, 0x3d40200bu, 0x50d03920u,
    0x3740b139u, 0xd34021b1u, 0xd0505821u, 0x14d0ed58u, 0x371095edu, 0xc4503895u, 0x17305738u, 0xcf40ae57u,
    0xd11014aeu, 0x44d07d14u, 0x3450887du, 0x14f0ab88u, 0x3c50a8abu, 0x151044a8u, 0x44f0af44u, 0x3c704aafu,
    0x1f10a54au, 0xc73047a5u, 0xcd308647u, 0x4cf08b86u, 0x3d40308bu, 0x50f01b30u, 0x3d30a61bu, 0x4cd04da6u,
    0x35c0924du, 0x73409e92u, 0xd330e79eu, 0xcfc053e7u, 0xf0f06f53u, 0x3f10e56fu, 0xc4707ae5u, 0x1d403c7au,
    0x53c0d33cu, 0xf31085d3u, 0xc530e685u, 0x4d40dce6u, 0x50d069dcu, 0x35405c69u, 0x50d0295cu, 0x37303729u,
    0xcf402e37u, 0xd310f52eu, 0xc45028f5u, 0x1510f428u, 0x453066f4u, 0x4cf08f66u, 0x3d30368fu, 0x4f404136u,
    0xd0d01941u, 0x34f03f19u, 0x3f40a13fu, 0xd34001a1u, 0xd050d801u, 0x154050d8u, 0x50d04950u, 0x3740d149u,
    0xd1404cd1u, 0x5110844cu, 0x44f0bb84u, 0x3d40d0bbu, 0x50d059d0u, 0x35c01259u, 0x70d0a912u, 0x3450c8a9u,
    0x1510c4c8u, 0x473087c4u, 0xcdc08287u, 0x71107482u, 0x4540bc74u, 0x50f09fbcu, 0x3d30569fu, 0x4d10a456u,
    0x451064a4u, 0x44d06d64u, 0x3530c66du, 0x4cd0adc6u, 0x3470baadu, 0x1fc003bau, 0xf1404003u, 0x51103440u,
    0x44d0d934u, 0x35c0e2d9u, 0x7070fae2u, 0x1d407cfau, 0x50f07b7cu, 0x3f10057bu, 0xc470ca05u, 0x1d3026cau,
    0x4fc09326u, 0xf1307693u, 0x4f407e76u, 0xd0f0ff7eu, 0x3dc052ffu, 0x73105552u, 0xc510d455u, 0x44f0cfd4u,
    0x3f40cecfu, 0xd0f03bceu, 0x3fc0e33bu, 0xf0f02fe3u, 0x3d40102fu, 0x50703a10u, 0x1f40113au, 0xd130b611u,
    0x4cd0bdb6u, 0x35401cbdu, 0x50702a1cu, 0x1cf0df2au, 0x3f30b7dfu, 0xcc70aab7u, 0x1f10d5aau, 0xc73077d5u,
    0xcc50f877u, 0x145098f8u, 0x15c00298u, 0x71402c02u, 0x50709a2cu, 0x1fc0a39au, 0xf13046a3u, 0x4cd0dd46u,
    0x34d099ddu, 0x37106599u, 0xc4f09b65u, 0x3f30a79bu, 0xccf02ba7u, 0x3d40ac2bu, 0x50d009acu, 0x37408109u,
    0xd1301681u, 0x4f302716u, 0xccd0fd27u, 0x37c013fdu, 0xf1c06213u, 0x71406c62u, 0x53406e6cu, 0xd0f04f6eu,
    0x3f40714fu, 0xd140e071u, 0x5050e8e0u, 0x15c0b2e8u, 0x70d0b9b2u, 0x354070b9u, 0x50506870u, 0x1470da68u,
    0x1d30f6dau, 0x4f4061f6u, 0xd110e461u, 0x44f0fbe4u, 0x3dc022fbu, 0x71c0f222u, 0x7340c1f2u, 0xd340eec1u,
    0xd1c0d2eeu, 0x714090d2u, 0x51400c90u, 0x50f0bf0cu, 0x3fc0b3bfu, 0xf1c0a2b3u, 0x7340f1a2u, 0xd34051f1u,
    0xd3c03351u, 0xf3409133u, 0xd0f0eb91u, 0x3cd0f9ebu, 0x37400ef9u, 0xd0f0ef0eu, 0x3cf06befu, 0x3f40316bu,
    0xd140c031u, 0x5130d6c0u, 0x4cf01fd6u, 0x3f10b51fu, 0xc730c7b5u, 0xcc706ac7u, 0x1cd09d6au, 0x3450b89du,
    0x151054b8u, 0x4540cc54u, 0x5140b0ccu, 0x53c073b0u, 0xf0d07973u, 0x35c03279u, 0x70d02d32u, 0x34f07f2du,
    0x3d10047fu, 0x45309604u, 0x4f40fe96u, 0xd0708afeu, 0x1d40ec8au, 0x50d0cdecu, 0x34d05dcdu, 0x3740de5du,
    0xd1c072deu, 0x73c04372u, 0xf0d01d43u, 0x3450181du, 0x14504818u, 0x17c0f348u, 0xf0d08df3u, 0x3540808du,
    0x53c0c380u, 0xf3404ec3u, 0xd1c0424eu, 0x7330d742u, 0xccd03dd7u, 0x35409c3du, 0x5110b49cu, 0x473097b4u);

uint density_noise_word(uint index)
{
    return DENSITY_NOISE_TABLE[index & 255u];
}

// Bits 31 and 30 of each, as a number: 2, -2 or 0.
vec4 density_noise_component(uvec4 words)
{
    return uintBitsToFloat(words & 0xC0000000u);
}

// Returns noise at q, in cells: at most 1.04 in size, and 0 at each lattice point. Where floats have no fractions it is
// 0.
float density_noise(vec3 q)
{
    vec3 corner = floor(q);
    uvec3 cell = uvec3(ivec3(corner));
    vec3 d = q - corner;
    vec3 weight = d * d * d * (d * (d * 6.0 - 15.0) + 10.0);
    uint along_x = density_noise_word(cell.x);
    uint near = density_noise_word(along_x + cell.y);
    uint far = density_noise_word((along_x >> 8) + cell.y);
    // Columns along z at (x, y): (0, 0), (1, 0), (0, 1), (1, 1).
    uvec4 words = uvec4(density_noise_word(near + cell.z), density_noise_word(far + cell.z),
                        density_noise_word((near >> 8) + cell.z), density_noise_word((far >> 8) + cell.z));
    vec4 x = vec4(d.x, d.x - 1.0, d.x, d.x - 1.0);
    vec4 y = vec4(d.y, d.y, d.y - 1.0, d.y - 1.0);
    vec4 low = density_noise_component(words) * x + density_noise_component(words << 2) * y +
               density_noise_component(words << 4) * d.z;
    vec4 high = density_noise_component(words << 6) * x + density_noise_component(words << 8) * y +
                density_noise_component(words << 10) * (d.z - 1.0);
    vec4 between = low + weight.z * (high - low);
    vec2 row = between.xy + weight.y * (between.zw - between.xy);
    return 0.5 * (row.x + weight.x * (row.y - row.x));
}
