// See form.h.
#include "glass/form.h"

namespace gonio::glass {

const Form* find_form(const std::string& id) {
  for (const Form* form : all_forms())
    if (form->id() == id) return form;
  return nullptr;
}

}  // namespace gonio::glass
