#include "effects/effect.h"

#include "a2rt/base/error.h"
#include "glsl/shared.h"

namespace a2rt::effects {

const std::vector<Effect>& all() {
  static const std::vector<Effect> effects = {
      {"diffuse",
       gpu::kEffectDiffuse,
       "light that diffuse surfaces pass on",
       "one bounce ray per diffuse hit",
       {"raygen", "closest-hit"},
       ""},
      {"shadow",
       gpu::kEffectShadow,
       "direct light of point-like lights, with sharp shadows",
       "one shadow ray per light and diffuse hit",
       {"raygen", "shadow miss"},
       "first-hit exit"},
      {"soft-shadow",
       gpu::kEffectSoftShadow,
       "direct light of lights with an extent",
       "one shadow ray to a random point of the light per light and diffuse hit",
       {"raygen", "shadow miss"},
       "first-hit exit"},
      {"ao",
       gpu::kEffectAmbientOcclusion,
       "ambient occlusion",
       "ao_rays short rays per primary hit",
       {"raygen", "shadow miss"},
       "first-hit exit"},
      {"mirror",
       gpu::kEffectMirror,
       "perfect reflection",
       "one ray per mirror hit",
       {"raygen", "closest-hit"},
       ""},
      {"rough",
       gpu::kEffectRough,
       "rough reflection",
       "one ray per glossy hit",
       {"raygen", "closest-hit"},
       ""},
      {"refraction",
       gpu::kEffectRefraction,
       "light through transmissive surfaces",
       "one refracted or reflected ray per transmissive hit",
       {"raygen", "closest-hit"},
       ""},
      {"volume",
       gpu::kEffectVolume,
       "absorption inside transmissive bodies",
       "",
       {"closest-hit"},
       ""},
      {"clearcoat",
       gpu::kEffectClearcoat,
       "a second, clear reflecting layer",
       "a reflected ray for some hits of coated surfaces",
       {"closest-hit"},
       ""},
      {"emission", gpu::kEffectEmission, "surfaces that shine", "", {"closest-hit"}, ""},
      {"sky", gpu::kEffectSky, "light from rays that leave the scene", "", {"miss"}, ""},
      {"alpha",
       gpu::kEffectAlpha,
       "masked and blended geometry",
       "none; every candidate triangle of such geometry runs a shader",
       {"any-hit"},
       "any-hit candidate path"},
      {"procedural",
       gpu::kEffectProcedural,
       "spheres and boxes given by formula",
       "none; every candidate box runs a shader",
       {"intersection", "procedural closest-hit"},
       "intersection-shader path"},
      {"instancing",
       gpu::kEffectInstancing,
       "geometry placed more than once or by a transform",
       "none; rays are transformed at instances",
       {},
       "transform unit"},
      {"textures",
       gpu::kEffectTextures,
       "colours and factors from images",
       "",
       {"closest-hit", "any-hit"},
       "texture unit"},
      {"normals",
       gpu::kEffectNormals,
       "shading normals interpolated between vertices",
       "",
       {"closest-hit"},
       ""},
      {"normal-maps",
       gpu::kEffectNormalMaps,
       "shading normals from images",
       "",
       {"closest-hit"},
       "texture unit"},
      {"culling",
       gpu::kEffectCulling,
       "single-sided surfaces are not seen from behind",
       "none; camera and bounce rays pass the backs of such triangles",
       {},
       "facing test"},
  };
  return effects;
}

const Effect& by_name(const std::string& name) {
  std::string known;
  for (const Effect& effect : all()) {
    if (effect.name == name) {
      return effect;
    }
    known += (known.empty() ? "" : ", ") + effect.name;
  }
  throw UserError("no effect '" + name + "'; known: auto, all, or a comma-separated list of " +
                  known);
}

}  // namespace a2rt::effects
