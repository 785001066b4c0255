/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Which of the tags that were read lie on one bar. */
#ifndef OPMS_TAG_LABELS_H
#define OPMS_TAG_LABELS_H

#include <vector>

#include <opms/bar.h>
#include <opms/types.h>

#include "tag_reader.h"

namespace opms_tag {

/** Keep the tags that agree with each other, by rising id, one of each.
 *
 * @param[in,out] tags  What was read; on return the tags of the bar, empty unless LOCATED.
 * @return ABSENT where tags is empty, LOCATED where two or more agree, AMBIGUOUS otherwise. */
opms_bar_state_t tags_of_one_bar(const opms_lens_t &lens, std::vector<Sighting> &tags);

} // namespace opms_tag

#endif
