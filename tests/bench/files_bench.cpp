// Pictures and meshes from and to files.
#include <benchmark/benchmark.h>
#include <stdlib.h>

#include <filesystem>

#include "base/atomic_file.h"
#include "base/random.h"
#include "io/exr.h"
#include "io/picture.h"
#include "io/ply.h"

namespace gonio {
namespace {

io::Image noisy_image(int width, int height) {
  Random random(1);
  io::Image image(width, height, {"R", "G", "B"});
  for (auto& v : image.data) v = static_cast<float>(random.uniform());
  return image;
}

void encode_exr(benchmark::State& state) {
  const io::Image image = noisy_image(1024, 768);
  for (auto _ : state) benchmark::DoNotOptimize(io::encode_exr(image));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(image.pixels()));
}
BENCHMARK(encode_exr)->Unit(benchmark::kMillisecond);

void decode_exr(benchmark::State& state) {
  const std::string bytes = io::encode_exr(noisy_image(1024, 768));
  for (auto _ : state) benchmark::DoNotOptimize(io::decode_exr(bytes, "picture"));
  state.SetItemsProcessed(state.iterations() * 1024 * 768);
}
BENCHMARK(decode_exr)->Unit(benchmark::kMillisecond);

void encode_png(benchmark::State& state) {
  const io::Image image = noisy_image(1024, 768);
  for (auto _ : state) benchmark::DoNotOptimize(io::encode_png(image));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(image.pixels()));
}
BENCHMARK(encode_png)->Unit(benchmark::kMillisecond);

// A grid of n x n vertices in ascii, the slowest form.
void parse_ascii_ply(benchmark::State& state) {
  constexpr int n = 300;
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(n * n) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                     std::to_string((n - 1) * (n - 1)) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < n * n; ++i) text += std::to_string(i % n) + " " + std::to_string(i / n) + " 0.123456\n";
  for (int i = 0; i < (n - 1) * (n - 1); ++i) text += "4 0 " + std::to_string(i) + " 2 3\n";
  for (auto _ : state) benchmark::DoNotOptimize(io::parse_ply(text, "mesh"));
  state.SetItemsProcessed(state.iterations() * n * n);
}
BENCHMARK(parse_ascii_ply)->Unit(benchmark::kMillisecond);

// To the disk and flushed, renamed, folder flushed: what every output costs at least.
void write_small_file(benchmark::State& state) {
  std::string folder = (std::filesystem::temp_directory_path() / "gonio-bench-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return state.SkipWithError("no temporary folder");
  for (auto _ : state) write_file(std::filesystem::path(folder) / "a", "content");
  std::filesystem::remove_all(folder);
}
BENCHMARK(write_small_file)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace gonio
