// Pictures of views as files that say what made them, so that a batch that was interrupted goes on where it stood. In
// the OpenEXR file's header stand, as texts:
//   software    of which version
//   recipe      a hash of all that the picture depends on: version, frames' contents, times, corrections, options
//   developed   the steps, as the manifest's images state them
//   mask        SHA-256 of the mask's file
// The mask is written first, so that a picture that is there is finished.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "manifest/value.h"
#include "photograph/raw_view.h"

namespace gonio::photograph {

struct ViewFiles {
  std::filesystem::path picture, mask;
};

// Of what all views of a batch share, and of one view with it. Error(no_input) for frames that are not there.
std::string identity_of(const RawRecipe& recipe);
std::string identity_of(const RawView& view, const std::string& recipe);

// `steps`: what was done, as the manifest's images state it.
void write_view(const DevelopedView& developed, const manifest::Value& steps, const std::string& identity,
                const ViewFiles& files);

// The steps of a view that an earlier call finished; nothing where its picture or its mask is not there.
// Error(cannot_create) where what is there is not what a call of this identity makes.
std::optional<manifest::Value> finished_view(const RawView& view, const std::string& identity, const ViewFiles& files);

}  // namespace gonio::photograph
