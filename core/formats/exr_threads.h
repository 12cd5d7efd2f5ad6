// Work on the threads of OpenEXR, of which a run has as many as it may take.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

namespace alcove {

/// How many threads OpenEXR has; 0: none but the caller's.
int exr_threads();

/// How many threads there are for so many pieces of work of which `most` may go on at once; 0: only the caller's.
int exr_threads_for(int pieces, int most);

/// Calls the function on so many threads at once, or on the caller's where that is 0, and waits for all of them. Throws
/// what the first one threw.
void on_exr_threads(int threads, const std::function<void()>& function);

}  // namespace alcove
