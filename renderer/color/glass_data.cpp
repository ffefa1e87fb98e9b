// Numbers: index of refraction of Schott glasses (refractiveindex.info, public domain).
#include <iterator>

#include "renderer/color/spectral_data.h"

namespace tessera {
namespace {

constexpr float kBK7Wavelengths[] = {300.0f, 322.0f, 344.0f, 366.0f, 388.0f, 410.0f, 432.0f, 454.0f,
                                     476.0f, 498.0f, 520.0f, 542.0f, 564.0f, 586.0f, 608.0f, 630.0f,
                                     652.0f, 674.0f, 696.0f, 718.0f, 740.0f, 762.0f, 784.0f, 806.0f,
                                     828.0f, 850.0f, 872.0f, 894.0f, 916.0f};
static_assert(std::size(kBK7Wavelengths) == 29);

constexpr float kBK7Eta[] = {1.55277026f, 1.54586993f, 1.54044669f, 1.53609053f, 1.53252773f, 1.52956877f,
                             1.52707843f, 1.52495785f, 1.52313317f, 1.52154825f, 1.52015969f, 1.51893348f,
                             1.51784265f, 1.51686556f, 1.51598467f, 1.51518565f, 1.51445666f, 1.51378789f,
                             1.51317111f, 1.5125994f,  1.51206689f, 1.51156859f, 1.51110021f, 1.51065806f,
                             1.51023896f, 1.50984013f, 1.50945918f, 1.50909398f, 1.50874267f};
static_assert(std::size(kBK7Eta) == 29);

constexpr float kBAF10Wavelengths[] = {350.0f, 371.0f, 393.0f, 414.0f, 436.0f, 457.0f, 479.0f,
                                       500.0f, 522.0f, 543.0f, 565.0f, 586.0f, 608.0f, 629.0f,
                                       651.0f, 672.0f, 694.0f, 715.0f, 737.0f, 758.0f, 780.0f,
                                       801.0f, 823.0f, 844.0f, 866.0f, 887.0f, 909.0f};
static_assert(std::size(kBAF10Wavelengths) == 27);

constexpr float kBAF10Eta[] = {1.71268808f, 1.704451f,   1.69785396f, 1.69245976f, 1.68797475f, 1.68419351f,
                               1.68096763f, 1.67818706f, 1.67576845f, 1.67364748f, 1.67177379f, 1.67010735f,
                               1.66861602f, 1.66727366f, 1.66605887f, 1.66495392f, 1.66394405f, 1.66301688f,
                               1.66216192f, 1.66137027f, 1.66063432f, 1.65994754f, 1.65930427f, 1.65869963f,
                               1.65812934f, 1.65758968f, 1.65707738f};
static_assert(std::size(kBAF10Eta) == 27);

constexpr float kFK51AWavelengths[] = {290.0f, 312.0f, 334.0f, 356.0f, 378.0f, 400.0f, 422.0f, 444.0f,
                                       466.0f, 488.0f, 511.0f, 533.0f, 555.0f, 577.0f, 599.0f, 621.0f,
                                       643.0f, 665.0f, 687.0f, 709.0f, 732.0f, 754.0f, 776.0f, 798.0f,
                                       820.0f, 842.0f, 864.0f, 886.0f, 908.0f};
static_assert(std::size(kFK51AWavelengths) == 29);

constexpr float kFK51AEta[] = {1.51457772f, 1.50921129f, 1.5049962f,  1.5016154f,  1.49885589f, 1.49656961f,
                               1.49465069f, 1.4930216f,  1.49162441f, 1.49041505f, 1.48935948f, 1.48843105f,
                               1.48760862f, 1.48687526f, 1.48621724f, 1.48562338f, 1.48508443f, 1.48459274f,
                               1.4841419f,  1.48372654f, 1.4833421f,  1.48298469f, 1.48265099f, 1.48233815f,
                               1.4820437f,  1.48176552f, 1.48150173f, 1.4812507f,  1.48101101f};
static_assert(std::size(kFK51AEta) == 29);

constexpr float kLASF9Wavelengths[] = {370.0f, 391.0f, 412.0f, 433.0f, 455.0f, 476.0f, 497.0f, 519.0f, 540.0f,
                                       561.0f, 583.0f, 604.0f, 625.0f, 646.0f, 668.0f, 689.0f, 710.0f, 732.0f,
                                       753.0f, 774.0f, 796.0f, 817.0f, 838.0f, 859.0f, 881.0f, 902.0f};
static_assert(std::size(kLASF9Wavelengths) == 26);

constexpr float kLASF9Eta[] = {1.91997255f, 1.90578582f, 1.89454016f, 1.88541219f, 1.87786364f, 1.8715257f,
                               1.86613626f, 1.86150348f, 1.85748348f, 1.85396617f, 1.85086586f, 1.84811481f,
                               1.84565882f, 1.843454f,   1.84146444f, 1.8396605f,  1.83801752f, 1.83651481f,
                               1.83513492f, 1.833863f,   1.83268638f, 1.83159418f, 1.83057698f, 1.82962663f,
                               1.82873604f, 1.82789897f};
static_assert(std::size(kLASF9Eta) == 26);

constexpr float kSF5Wavelengths[] = {370.0f, 391.0f, 412.0f, 433.0f, 455.0f, 476.0f, 497.0f, 519.0f, 540.0f,
                                     561.0f, 583.0f, 604.0f, 625.0f, 646.0f, 668.0f, 689.0f, 710.0f, 732.0f,
                                     753.0f, 774.0f, 796.0f, 817.0f, 838.0f, 859.0f, 881.0f, 902.0f};
static_assert(std::size(kSF5Wavelengths) == 26);

constexpr float kSF5Eta[] = {1.72865498f, 1.71701519f, 1.70790372f, 1.70057243f, 1.69454728f, 1.68951105f,
                             1.68524227f, 1.6815811f,  1.67840901f, 1.6756361f,  1.67319289f, 1.67102482f,
                             1.66908843f, 1.66734866f, 1.66577696f, 1.66434982f, 1.66304775f, 1.6618544f,
                             1.66075604f, 1.659741f,   1.65879933f, 1.65792249f, 1.65710312f, 1.65633485f,
                             1.65561212f, 1.65493008f};
static_assert(std::size(kSF5Eta) == 26);

constexpr float kSF10Wavelengths[] = {380.0f, 401.0f, 422.0f, 443.0f, 464.0f, 486.0f, 507.0f, 528.0f, 549.0f,
                                      570.0f, 592.0f, 613.0f, 634.0f, 655.0f, 676.0f, 698.0f, 719.0f, 740.0f,
                                      761.0f, 782.0f, 804.0f, 825.0f, 846.0f, 867.0f, 888.0f, 910.0f};
static_assert(std::size(kSF10Wavelengths) == 26);

constexpr float kSF10Eta[] = {1.79057889f, 1.77760746f, 1.76736206f, 1.75906491f, 1.75221275f, 1.74646357f,
                              1.74157588f, 1.73737382f, 1.73372607f, 1.73053246f, 1.72771518f, 1.7252129f,
                              1.72297659f, 1.7209666f,  1.71915051f, 1.71750161f, 1.71599765f, 1.71461998f,
                              1.71335289f, 1.71218299f, 1.71109887f, 1.71009072f, 1.70915005f, 1.70826952f,
                              1.70744272f, 1.70666405f};
static_assert(std::size(kSF10Eta) == 26);

constexpr float kSF11Wavelengths[] = {370.0f, 391.0f, 412.0f, 433.0f, 455.0f, 476.0f, 497.0f, 519.0f, 540.0f,
                                      561.0f, 583.0f, 604.0f, 625.0f, 646.0f, 668.0f, 689.0f, 710.0f, 732.0f,
                                      753.0f, 774.0f, 796.0f, 817.0f, 838.0f, 859.0f, 881.0f, 902.0f};
static_assert(std::size(kSF11Wavelengths) == 26);

constexpr float kSF11Eta[] = {1.87002162f, 1.85162559f, 1.83747077f, 1.82623238f, 1.81709469f, 1.80952423f,
                              1.80315558f, 1.79772912f, 1.79305486f, 1.78899037f, 1.7854266f,  1.78227867f,
                              1.77947944f, 1.77697515f, 1.77472223f, 1.772685f,   1.770834f,   1.76914468f,
                              1.76759641f, 1.76617177f, 1.76485595f, 1.76363626f, 1.76250181f, 1.76144317f,
                              1.76045216f, 1.75952163f};
static_assert(std::size(kSF11Eta) == 26);

constexpr SpectralSeries kGlassSeries[] = {
    {.name = "glass-BK7", .values = kBK7Eta, .wavelengths = kBK7Wavelengths},
    {.name = "glass-BAF10", .values = kBAF10Eta, .wavelengths = kBAF10Wavelengths},
    {.name = "glass-FK51A", .values = kFK51AEta, .wavelengths = kFK51AWavelengths},
    {.name = "glass-LASF9", .values = kLASF9Eta, .wavelengths = kLASF9Wavelengths},
    {.name = "glass-SF5", .values = kSF5Eta, .wavelengths = kSF5Wavelengths},
    {.name = "glass-F5", .values = kSF5Eta, .wavelengths = kSF5Wavelengths},
    {.name = "glass-SF10", .values = kSF10Eta, .wavelengths = kSF10Wavelengths},
    {.name = "glass-F10", .values = kSF10Eta, .wavelengths = kSF10Wavelengths},
    {.name = "glass-SF11", .values = kSF11Eta, .wavelengths = kSF11Wavelengths},
    {.name = "glass-F11", .values = kSF11Eta, .wavelengths = kSF11Wavelengths},
};

}  // namespace

std::span<const SpectralSeries> GlassSeries() {
  return kGlassSeries;
}

}  // namespace tessera
