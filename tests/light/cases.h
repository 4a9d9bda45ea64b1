// Lights of every registered model with drawn parameters: nothing here names a model.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/random.h"
#include "light/light.h"

namespace gonio::tests {

struct LightCase {
  std::string name;
  manifest::Parameters parameters;
  std::unique_ptr<light::Emitter> emitter;
};

// A dim surround with a bright spot, a coloured one and black rows.
inline std::shared_ptr<const io::Image> test_surround() {
  auto picture = std::make_shared<io::Image>(24, 12, std::vector<std::string>{"R", "G", "B"});
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 24; ++x)
      for (int c = 0; c < 3; ++c)
        picture->at(x, y, c) = y == 7 ? 0.0f : 0.1f * static_cast<float>(1 + (x * 7 + y * 5 + c) % 9);
  for (int c = 0; c < 3; ++c) picture->at(5, 3, c) = 40;
  picture->at(20, 9, 2) = 15;
  return picture;
}

inline manifest::Parameters draw_parameters(const manifest::ModelInfo& info, Random& random) {
  manifest::Parameters parameters;
  for (const auto& p : info.parameters) {
    const double lower = std::isfinite(p.lower) ? p.lower : -1, upper = std::isfinite(p.upper) ? p.upper : lower + 1;
    std::vector<double> value;
    for (int i = 0; i < p.components; ++i) value.push_back(random.uniform(lower, upper));
    parameters[p.name] = value;
  }
  return parameters;
}

// What a model reads: the picture above, or the file of tests/light/attachments whose stem is the model's id.
inline light::Attachment attachment_of(const manifest::ModelInfo& info) {
  if (info.attachment == manifest::Attachment::none) return {};
  if (info.attachment == manifest::Attachment::picture) return {test_surround(), {}};
  const auto folder = std::filesystem::path(GONIO_SOURCE) / "tests" / "light" / "attachments";
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().stem() == info.id) return {nullptr, entry.path()};
  ADD_FAILURE() << "tests/light/attachments has no file for " << info.id;
  return {};
}

inline std::vector<LightCase> light_cases(int each, std::uint64_t seed) {
  std::vector<LightCase> cases;
  Random random(seed);
  for (const light::Model* model : light::all_models())
    for (int k = 0; k < each; ++k) {
      auto parameters = draw_parameters(model->info(), random);
      auto emitter = model->prepare(parameters, attachment_of(model->info()), "p");
      cases.push_back({model->info().id + " drawn " + std::to_string(k), std::move(parameters), std::move(emitter)});
    }
  return cases;
}

// Mean of cos * weight over a regular grid of the sampler's random numbers: irradiance of a plane with this normal.
inline Rgb irradiance_by_sampling(const light::Emitter& emitter, Vec3 point_m, Vec3 normal, int grid = 400) {
  Rgb sum;
  for (int i = 0; i < grid; ++i)
    for (int j = 0; j < grid; ++j) {
      const auto s = emitter.sample(point_m, {(i + 0.5) / grid, (j + 0.5) / grid});
      if (s.valid) sum += s.weight * std::max(0.0, dot(normal, s.direction));
    }
  return sum / (1.0 * grid * grid);
}

}  // namespace gonio::tests
