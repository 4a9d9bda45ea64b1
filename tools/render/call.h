// render behind its description: what is asked for is checked, rendered or merged, written and entered
// into the manifest.
#pragma once
#include "base/error.h"
#include "cli/program.h"

namespace gonio::tools::render {

void check(cli::Invocation& call);
// Exit::quality where a picture is noisier than --noise asks for.
Exit render_images(cli::Invocation& call);
Exit merge(cli::Invocation& call);

}  // namespace gonio::tools::render
