/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Deletes a scan's folder, and nothing else. */
#ifndef OPMS_CLI_CATALOGUE_DELETE_HPP
#define OPMS_CLI_CATALOGUE_DELETE_HPP

#include <string>

/** Whether a folder is that of a scan that may be deleted: it holds a scan's database and nothing
 * that does not belong to a scan, and nobody records into it. @p error says what speaks against. */
bool catalogue_may_delete(const std::string &folder, std::string &error);

/** Delete it. It is gone from the list at once, even if the deletion is cut off. False with
 * @p error, and where it may not be deleted. */
bool catalogue_delete(const std::string &folder, std::string &error);

#endif
