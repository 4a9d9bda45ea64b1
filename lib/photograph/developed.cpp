// See developed.h.
#include "photograph/developed.h"

#include <algorithm>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"

namespace gonio::photograph {
namespace {

bool has(const manifest::ImageEntry& image, const std::string& step) {
  return std::ranges::find(image.developed, step, &manifest::DevelopedStep::step) != image.developed.end();
}

std::string place_of(const manifest::Document& document, std::size_t image) {
  return manifest::place(document, "/images/" + std::to_string(image));
}

// A picture that is named again is the same picture.
bool same_file(const manifest::Document& document, std::size_t a, std::size_t b) {
  if (a == b) return true;
  if (document.images[a].file.empty() || document.images[b].file.empty()) return false;
  const auto place = [&](std::size_t i) { return manifest::picture_path(document, i).lexically_normal(); };
  return document.images[a].file == document.images[b].file || place(a) == place(b);
}

}  // namespace

std::string words_of_steps(const manifest::ImageEntry& image) {
  std::string words;
  for (const manifest::DevelopedStep& step : image.developed)
    words += (words.empty() ? "" : ", ") + step.step + (step.by.empty() ? "" : " by " + step.by);
  return words;
}

void refuse_second(const manifest::Document& document, std::size_t image, const std::string& step,
                   const std::string& problem, const std::string& remedy) {
  for (std::size_t other = 0; other < document.images.size(); ++other)
    if (has(document.images[other], step) && same_file(document, image, other))
      throw Error(Exit::data, place_of(document, image),
                  problem + " (developed: " + words_of_steps(document.images[other]) + ")", remedy);
}

void refuse_developed(const manifest::Document& document, std::size_t image, const std::string& remedy) {
  if (document.images[image].developed.empty()) return;
  throw Error(Exit::data, place_of(document, image),
              "is no raw frame any more (developed: " + words_of_steps(document.images[image]) + ")", remedy);
}

}  // namespace gonio::photograph
