#include "server/certificate_checkup.hpp"

#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace wayfuse {
namespace {

constexpr int kSoonDays = 30;

using File = std::unique_ptr<std::FILE, decltype(&std::fclose)>;
using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;
using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

std::string names_in(X509* certificate) {
  std::string names;
  auto* list = static_cast<GENERAL_NAMES*>(X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr));
  for (int i = 0; list && i < sk_GENERAL_NAME_num(list); ++i) {
    const GENERAL_NAME* name = sk_GENERAL_NAME_value(list, i);
    if (name->type != GEN_DNS) continue;
    names += (names.empty() ? "" : ", ") +
             std::string(reinterpret_cast<const char*>(ASN1_STRING_get0_data(name->d.dNSName)), static_cast<std::size_t>(ASN1_STRING_length(name->d.dNSName)));
  }
  GENERAL_NAMES_free(list);
  return names.empty() ? "no DNS name" : names;
}

int no_passphrase(char*, int, int, void*) {
  return 0;
}

void add(std::vector<Finding>& findings, Severity severity, std::string what, std::string mend) {
  findings.push_back({"tls", severity, std::move(what), std::move(mend)});
}

void check_dates(const X509* certificate, const std::string& file, std::vector<Finding>& findings) {
  int days = 0, seconds = 0;
  ASN1_TIME_diff(&days, &seconds, nullptr, X509_get0_notAfter(certificate));
  if (X509_cmp_current_time(X509_get0_notBefore(certificate)) > 0) {
    add(findings, Severity::kError, file + " is not valid yet", "set the clock, or have the certificate issued anew");
  } else if (days < 0 || seconds < 0) {
    add(findings, Severity::kError, file + " expired " + std::to_string(-days) + " days ago", "renew it, then systemctl reload wayfused (SIGHUP)");
  } else if (days < kSoonDays) {
    add(findings, Severity::kWarning, file + " expires in " + std::to_string(days) + " days", "renew it, then systemctl reload wayfused (SIGHUP)");
  } else {
    add(findings, Severity::kGood, "certificate for " + names_in(const_cast<X509*>(certificate)) + ", " + std::to_string(days) + " days left", "");
  }
}

}  // namespace

void check_certificate(const NetSettings& net, std::vector<Finding>& findings) {
  if (net.tls_certificate.empty() && net.tls_key.empty()) return;
  if (net.tls_certificate.empty() || net.tls_key.empty())
    return add(findings, Severity::kError, "one of tls.certificate and tls.key is missing", "set both");
  const File certificate_file(std::fopen(net.tls_certificate.c_str(), "re"), &std::fclose);
  if (!certificate_file) return add(findings, Severity::kError, net.tls_certificate + ": " + std::strerror(errno), "let tls.certificate name a file that can be read");
  const Certificate certificate(PEM_read_X509(certificate_file.get(), nullptr, nullptr, nullptr), &X509_free);
  if (!certificate) return add(findings, Severity::kError, net.tls_certificate + " holds no PEM certificate", "convert it: openssl x509 -inform der -out server.pem");
  const File key_file(std::fopen(net.tls_key.c_str(), "re"), &std::fclose);
  if (!key_file) return add(findings, Severity::kError, net.tls_key + ": " + std::strerror(errno), "chgrp it to the service's user and chmod 0640");
  const Key key(PEM_read_PrivateKey(key_file.get(), nullptr, no_passphrase, nullptr), &EVP_PKEY_free);
  if (!key) return add(findings, Severity::kError, net.tls_key + " holds no PEM private key without a passphrase", "openssl pkey -in ENCRYPTED -out " + net.tls_key);
  if (X509_check_private_key(certificate.get(), key.get()) != 1)
    return add(findings, Severity::kError, net.tls_key + " is not the key of " + net.tls_certificate, "name the pair that was issued together; the server's own certificate comes first in its file");
  struct stat mode {};
  if (::stat(net.tls_key.c_str(), &mode) == 0 && (mode.st_mode & S_IRWXO) != 0)
    add(findings, Severity::kWarning, net.tls_key + " can be read by every user of this machine", "chmod o= " + net.tls_key);
  check_dates(certificate.get(), net.tls_certificate, findings);
}

}  // namespace wayfuse
