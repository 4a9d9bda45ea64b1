// Denoising that keeps edges, by CImg, whose header this source alone includes.
//
// Non-local means (Buades, Coll & Morel 2005): patches of 3 x 3 x 3 voxels within 2 voxels on either side count alike
// where their mean squared difference is below 3 sigma_r^2; of noise alone it is 2 sd^2.
//
// Tensor diffusion (Tschumperle 2006) by line integrals along a tensor field of our own, whose scale is the noise and
// not the block's extremes, as CImg's own tensors have it: blocks would show. Across edges smoothing stops, along them
// it goes on at half its strength.
#include "volume/correct_parts.h"

#define cimg_display 0
#define cimg_verbosity 0
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#include <CImg.h>
#pragma GCC diagnostic pop

#include <cmath>

namespace gonio::volume {
namespace {

using Image = cimg_library::CImg<float>;

Image tensors_of(const Image& image, double noise) {
  Image tensors = image.get_blur(0.8f).get_structure_tensors();
  tensors.blur(1.2f);
  // The gradient of noise blurred by 0.8 voxels, squared and summed over three axes, is about 0.1 of its variance.
  const float level = static_cast<float>(0.5 * noise * noise);
  Image values(3), vectors(3, 3);
  const std::size_t plane = static_cast<std::size_t>(tensors.width()) * static_cast<std::size_t>(tensors.height()) *
                            static_cast<std::size_t>(tensors.depth());
  for (int z = 0; z < tensors.depth(); ++z)
    for (int y = 0; y < tensors.height(); ++y)
      for (int x = 0; x < tensors.width(); ++x) {
        tensors.get_tensor_at(x, y, z).symmetric_eigen(values, vectors);
        const int greatest = values[0] >= values[1] && values[0] >= values[2] ? 0 : values[1] >= values[2] ? 1 : 2;
        const float total = std::max(0.f, values[0]) + std::max(0.f, values[1]) + std::max(0.f, values[2]);
        const float across = 1 / (1 + total * total / (level * level)), along = 0.5f + 0.5f * across;
        const float drop = across - along;
        const float n[3] = {vectors(greatest, 0), vectors(greatest, 1), vectors(greatest, 2)};
        float* t = tensors.data(x, y, z, 0);
        t[0] = along + drop * n[0] * n[0], t[plane] = drop * n[0] * n[1], t[2 * plane] = drop * n[0] * n[2];
        t[3 * plane] = along + drop * n[1] * n[1], t[4 * plane] = drop * n[1] * n[2];
        t[5 * plane] = along + drop * n[2] * n[2];
      }
  return tensors;
}

}  // namespace

void denoise_block(std::span<float> block, std::size_t width, std::size_t height, std::size_t depth,
                   const CorrectWish& wish) {
  const auto size = [](std::size_t n) { return static_cast<unsigned>(n); };
  Image image(block.data(), size(width), size(height), size(depth), 1, true);  // shares the memory
  if (wish.denoise == Denoise::non_local) {
    const auto sigma_r = static_cast<float>(1.2 * wish.noise * wish.strength);
    image.assign(image.get_blur_patch(10.f, sigma_r, 3, 5, 0, true));
  } else if (wish.denoise == Denoise::anisotropic) {
    const Image tensors = tensors_of(image, wish.noise);
    image.blur_anisotropic(tensors, static_cast<float>(1.5 * wish.strength), 0.8f, 45.f, 2.f, 1, true);
  }
}

}  // namespace gonio::volume
