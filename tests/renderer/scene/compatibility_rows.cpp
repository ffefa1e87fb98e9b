#include "tests/renderer/scene/compatibility_rows.h"

namespace tessera {
namespace {

#define SHUTTER "float shutteropen=0;float shutterclose=1"
#define PROJECTIVE                                                                     \
  SHUTTER                                                                              \
  ";float frameaspectratio=2;float screenwindow=-1 1 -1 1;float lensradius=0.1;float " \
  "focaldistance=4"
#define FILM                                                                                           \
  "string filename=\"a.exr\";integer xresolution=8;integer yresolution=8;integer pixelbounds=0 4 0 4;" \
  "float cropwindow=0 .5 0 .5;float diagonal=20;float iso=200;float whitebalance=5000;"                \
  "string sensor=\"canon_eos_100d\";float maxcomponentvalue=10;bool savefp16=true"
#define RADII "float xradius=1;float yradius=1"
#define SAMPLES "integer pixelsamples=16;integer seed=1"
#define SCRAMBLED SAMPLES ";string randomization=\"none\""
#define PATH "integer maxdepth=3;string lightsampler=\"power\";bool regularize=true"
#define ALPHA "float alpha=0.5;texture alpha=\"float\""
#define QUADRIC "float radius=1;float phimax=180;" ALPHA
#define MESH "normal N=0 0 1 0 0 1 0 0 1;point2 uv=0 0 1 0 0 1;integer faceIndices=0;" ALPHA
#define RELIEF "float displacement=0.1;texture displacement=\"float\";string normalmap=\"image.pfm\""
#define ROUGH                                                                                       \
  "float roughness=0.1;float uroughness=0.1;float vroughness=0.1;texture roughness=\"float\";bool " \
  "remaproughness=true"
#define ETA "float eta=1.4;spectrum eta=\"glass-BK7\""
#define LAYER "float thickness=0.1;float g=0.1;rgb albedo=0.1 0.1 0.1;integer maxdepth=5;integer nsamples=2"
#define ALBEDO "rgb reflectance=.5 .5 .5;spectrum reflectance=400 .2 700 .3;texture reflectance=\"spectrum\""
#define MAPPING "string mapping=\"spherical\";float uscale=2;float vscale=2;float udelta=1;float vdelta=1;"
#define TWO_FLOATS "float tex1=1;texture tex1=\"float\";float tex2=0;texture tex2=\"float\""
#define TWO_SPECTRA "rgb tex1=1 1 1;texture tex1=\"spectrum\";rgb tex2=0 0 0;texture tex2=\"spectrum\""
#define AMOUNT ";float amount=.2;texture amount=\"float\""
#define IMAGE                                                                                         \
  MAPPING                                                                                             \
  "string wrap=\"clamp\";string filter=\"ewa\";float maxanisotropy=4;float scale=2;bool invert=true;" \
  "string encoding=\"linear\""
#define INTENSITY "rgb I=1 1 1;spectrum I=\"stdillum-A\";blackbody I=5000;float scale=2;float power=10"
#define RADIANCE "rgb L=1 1 1;spectrum L=\"stdillum-A\";blackbody L=5000;float scale=2"
#define SIGMA "rgb sigma_a=1 1 1;rgb sigma_s=1 1 1;float g=0.1"
#define BOX "point3 p0=0 0 0;point3 p1=1 1 1"
#define GRID "integer nx=1;integer ny=1;integer nz=1;" BOX
#define TEMPERATURE "float temperatureoffset=1;float temperaturecutoff=1;float temperaturescale=2"

constexpr KindRow kRows[] = {
    {"camera", "perspective", "", "float fov=45;" PROJECTIVE},
    {"camera", "orthographic", "", PROJECTIVE},
    {"camera", "spherical", "", PROJECTIVE ";string mapping=\"equirectangular\""},
    {"camera", "realistic", "string lensfile=\"lens.dat\"",
     SHUTTER ";float aperturediameter=2;float focusdistance=3;string aperture=\"star\""},
    {"film", "rgb", "", FILM},
    {"film", "gbuffer", "", FILM ";string coordinatesystem=\"world\""},
    {"film", "spectral", "", FILM ";integer nbuckets=4;float lambdamin=400;float lambdamax=700"},
    {"filter", "box", "", RADII},
    {"filter", "gaussian", "", RADII ";float sigma=0.4"},
    {"filter", "mitchell", "", RADII ";float B=0.3;float C=0.3"},
    {"filter", "sinc", "", RADII ";float tau=2"},
    {"filter", "triangle", "", RADII},
    {"sampler", "independent", "", SAMPLES},
    {"sampler", "stratified", "", "bool jitter=true;integer xsamples=2;integer ysamples=2;integer seed=1"},
    {"sampler", "halton", "", SCRAMBLED},
    {"sampler", "sobol", "", SCRAMBLED},
    {"sampler", "paddedsobol", "", SCRAMBLED},
    {"sampler", "zsobol", "", SCRAMBLED},
    {"sampler", "pmj02bn", "", SAMPLES},
    {"integrator", "path", "", PATH},
    {"integrator", "volpath", "", PATH},
    {"integrator", "mixture", "", "integer maxdepth=3;string lightsampler=\"power\""},
    {"integrator", "simplepath", "", "integer maxdepth=3;bool samplelights=true;bool samplebsdf=true"},
    {"integrator", "simplevolpath", "", "integer maxdepth=3"},
    {"integrator", "randomwalk", "", "integer maxdepth=3"},
    {"integrator", "bdpt", "",
     "integer maxdepth=3;bool visualizestrategies=false;bool visualizeweights=false;bool regularize=false"},
    {"integrator", "lightpath", "", "integer maxdepth=3"},
    {"integrator", "mlt", "",
     "integer maxdepth=3;integer bootstrapsamples=9;integer chains=9;integer mutationsperpixel=9;"
     "float largestepprobability=.3;float sigma=.01;bool regularize=false"},
    {"integrator", "sppm", "",
     "integer maxdepth=3;integer photonsperiteration=9;float radius=1;integer seed=1"},
    {"integrator", "ambientocclusion", "", "bool cossample=true;float maxdistance=1"},
    {"integrator", "function", "",
     "string function=\"disk\";string filename=\"a.txt\";bool skipbad=true;string imagefilename=\"a.exr\""},
    {"light sampler", "uniform", "", ""},
    {"light sampler", "power", "", ""},
    {"light sampler", "bvh", "", ""},
    {"light sampler", "exhaustive", "", ""},
    {"accelerator", "bvh", "", "string splitmethod=\"sah\";integer maxnodeprims=4"},
    {"accelerator", "kdtree", "",
     "integer intersectcost=5;integer traversalcost=1;float emptybonus=.5;integer maxprims=1;integer "
     "maxdepth=4"},
    {"shape", "sphere", "", QUADRIC ";float zmin=-.5;float zmax=.5"},
    {"shape", "disk", "", QUADRIC ";float height=.1;float innerradius=.1"},
    {"shape", "cylinder", "", QUADRIC ";float zmin=-.5;float zmax=.5"},
    {"shape", "trianglemesh", "point3 P=0 0 0 1 0 0 0 1 0",
     "integer indices=0 1 2;vector3 S=1 0 0 1 0 0 1 0 0;" MESH},
    {"shape", "plymesh", "string filename=\"mesh.ply\"",
     "float edgelength=1;texture displacement=\"float\";" ALPHA},
    {"shape", "bilinearmesh", "point3 P=0 0 0 1 0 0 0 1 0 1 1 0",
     "integer indices=0 1 2 3;normal N=0 0 1 0 0 1 0 0 1 0 0 1;point2 uv=0 0 1 0 0 1 1 1;integer "
     "faceIndices=0;"
     "string emissionfilename=\"image.pfm\";" ALPHA},
    {"shape", "curve", "point3 P=0 0 0 1 0 0 1 1 0 2 1 0;string type=\"ribbon\";normal N=0 0 1 0 0 1",
     "string basis=\"bspline\";integer degree=3;float "
     "width=.1;float width0=.1;"
     "float width1=.1;integer splitdepth=2;" ALPHA},
    {"shape", "loopsubdiv", "point3 P=0 0 0 1 0 0 0 1 0 ;integer indices=0 1 2",
     "integer levels=1;string scheme=\"loop\";" ALPHA},
    {"material", "diffuse", "", ALBEDO ";" RELIEF},
    {"material", "diffusetransmission", "",
     ALBEDO ";rgb transmittance=.2 .2 .2;texture transmittance=\"spectrum\";float scale=.5;" RELIEF},
    {"material", "conductor", "",
     "spectrum eta=\"metal-Au-eta\";spectrum k=\"metal-Au-k\";" ALBEDO ";" ROUGH ";" RELIEF},
    {"material", "dielectric", "", ETA ";" ROUGH ";" RELIEF},
    {"material", "thindielectric", "", ETA ";" RELIEF},
    {"material", "coateddiffuse", "", ALBEDO ";" ROUGH ";" ETA ";" LAYER ";" RELIEF},
    {"material", "coatedconductor", "",
     "float interface.roughness=.1;float interface.uroughness=.1;float interface.vroughness=.1;float "
     "interface.eta=1.4;"
     "float conductor.roughness=.1;float conductor.uroughness=.1;float conductor.vroughness=.1;"
     "spectrum conductor.eta=\"metal-Au-eta\";spectrum conductor.k=\"metal-Au-k\";bool "
     "remaproughness=true;" ALBEDO ";" LAYER ";" RELIEF},
    {"material", "hair", "",
     "rgb sigma_a=1 1 1;rgb reflectance=.5 .5 .5;rgb color=.5 .5 .5;float eumelanin=1;float "
     "pheomelanin=1;float eta=1.5;"
     "float beta_m=.2;float beta_n=.2;float alpha=3"},
    {"material", "measured", "string filename=\"brdf.bsdf\"", RELIEF},
    {"material", "subsurface", "rgb sigma_a=1 1 1;rgb sigma_s=1 1 1",
     "string name=\"Skin1\";rgb mfp=1 1 1;float scale=2;float eta=1.4;float g=.1;" ALBEDO ";" ROUGH
     ";" RELIEF},
    {"material", "mix", "string materials=\"named\" \"named\"", "float amount=.3;texture amount=\"float\""},
    {"material", "interface", "", ""},
    {"material", "none", "", ""},
    {"float texture", "bilerp", "", MAPPING "float v00=1;float v01=1;float v10=1;float v11=1"},
    {"float texture", "checkerboard", "", MAPPING "integer dimension=3;" TWO_FLOATS},
    {"float texture", "constant", "", "float value=.5"},
    {"float texture", "directionmix", "", TWO_FLOATS ";vector3 dir=1 0 0"},
    {"float texture", "dots", "",
     MAPPING "float inside=1;texture inside=\"float\";float outside=0;texture outside=\"float\""},
    {"float texture", "fbm", "", "integer octaves=3;float roughness=.4"},
    {"float texture", "imagemap", "string filename=\"image.pfm\"", IMAGE},
    {"float texture", "mix", "", TWO_FLOATS AMOUNT},
    {"float texture", "scale", "", "float tex=1;texture tex=\"float\";float scale=2;texture scale=\"float\""},
    {"float texture", "windy", "", ""},
    {"float texture", "wrinkled", "", "integer octaves=3;float roughness=.4"},
    {"float texture", "ptex", "string filename=\"a.ptx\"", ""},
    {"spectrum texture", "bilerp", "", MAPPING "rgb v00=1 1 1;rgb v01=1 1 1;rgb v10=1 1 1;rgb v11=1 1 1"},
    {"spectrum texture", "checkerboard", "", MAPPING "integer dimension=3;" TWO_SPECTRA},
    {"spectrum texture", "constant", "", "rgb value=.5 .5 .5"},
    {"spectrum texture", "directionmix", "", TWO_SPECTRA ";vector3 dir=1 0 0"},
    {"spectrum texture", "dots", "",
     MAPPING "rgb inside=1 1 1;texture inside=\"spectrum\";rgb outside=0 0 0;texture outside=\"spectrum\""},
    {"spectrum texture", "imagemap", "string filename=\"image.pfm\"", IMAGE},
    {"spectrum texture", "marble", "",
     "integer octaves=3;float roughness=.4;float scale=2;float variation=.1"},
    {"spectrum texture", "mix", "", TWO_SPECTRA AMOUNT},
    {"spectrum texture", "scale", "",
     "rgb tex=1 1 1;texture tex=\"spectrum\";float scale=2;texture scale=\"float\""},
    {"spectrum texture", "ptex", "string filename=\"a.ptx\"", ""},
    {"medium", "homogeneous", "",
     "string preset=\"Skin1\";" SIGMA ";float scale=2;rgb Le=1 1 1;float Lescale=2"},
    {"medium", "uniformgrid", "float density=1",
     GRID ";" SIGMA ";float scale=2;rgb Le=1 1 1;float Lescale=2;float temperature=900;" TEMPERATURE},
    {"medium", "rgbgrid", "rgb sigma_a=1 1 1",
     GRID ";rgb sigma_s=1 1 1;rgb Le=1 1 1;float Lescale=2;float scale=2;float g=.1"},
    {"medium", "cloud", "", "float density=1;float wispiness=1;float frequency=5;" SIGMA ";" BOX},
    {"medium", "nanovdb", "string filename=\"cloud.nvdb\"",
     "string gridname=\"density\";string temperaturename=\"temperature\";float Lescale=2;float scale=2;" SIGMA
     ";" TEMPERATURE},
    {"light", "point", "", INTENSITY ";point3 from=0 1 0"},
    {"light", "spot", "",
     INTENSITY ";point3 from=0 1 0;point3 to=0 0 3;float coneangle=20;float conedeltaangle=4"},
    {"light", "distant", "", RADIANCE ";float illuminance=10;point3 from=0 1 0;point3 to=0 0 3"},
    {"light", "infinite", "",
     RADIANCE ";string filename=\"image.pfm\";float illuminance=10;point3 portal=0 0 5 0 1 5 1 1 5 1 0 5"},
    {"light", "goniometric", "string filename=\"image.pfm\"", INTENSITY},
    {"light", "projection", "string filename=\"image.pfm\"", "float fov=40;float power=10;float scale=2"},
    {"area light", "diffuse", "",
     RADIANCE ";string filename=\"image.pfm\";bool twosided=true;float power=10"},
    {"option", "disablepixeljitter", "", ""},
    {"option", "disabletexturefiltering", "", ""},
    {"option", "disablewavelengthjitter", "", ""},
    {"option", "displacementedgescale", "", ""},
    {"option", "forcediffuse", "", ""},
    {"option", "msereferenceimage", "", ""},
    {"option", "msereferenceout", "", ""},
    {"option", "pixelstats", "", ""},
    {"option", "rendercoordsys", "", ""},
    {"option", "seed", "", ""},
    {"option", "wavefront", "", ""},
};

}  // namespace

std::span<const KindRow> KindRows() {
  return kRows;
}

}  // namespace tessera
