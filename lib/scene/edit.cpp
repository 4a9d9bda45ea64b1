#include "scene/edit.h"

namespace gonio::scene {

const Edit* find_edit(const mechanism::Mechanism& mechanism) {
  for (const Edit* edit : all_edits())
    if (edit->mechanism().id == mechanism.id) return edit;
  return nullptr;
}

}  // namespace gonio::scene
