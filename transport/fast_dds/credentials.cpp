#include "transport/fast_dds/credentials.hpp"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>
#include <openssl/x509_vfy.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string_view>

#include "core/config_error.hpp"
#include "core/input_file.hpp"

namespace hybridtest::fast_dds {
namespace {

constexpr std::size_t kCredentialBytesMax = 1U << 20U;
constexpr const char* kMakeAgain = "make the credentials again with launch/security/make_credentials";

template <auto Free>
struct Freed {
  template <class Object>
  void operator()(Object* object) const noexcept {
    Free(object);
  }
};
using Bio = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Store = std::unique_ptr<X509_STORE, Freed<X509_STORE_free>>;
using StoreContext = std::unique_ptr<X509_STORE_CTX, Freed<X509_STORE_CTX_free>>;
using Pkcs7 = std::unique_ptr<PKCS7, Freed<PKCS7_free>>;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  ERR_clear_error();
  throw ConfigError{{ConfigIssue{.file = file.string(), .what = what}}};
}

/// The text stays in this process for the time of the check only.
Bio open_file(const std::filesystem::path& file, std::string& text, const char* expected) {
  if (const auto why = why_unreadable(file)) {
    refuse(file, *why +
                     "; --credentials names the folder of one participant, as written by "
                     "launch/security/make_credentials");
  }
  text = read_input_file(file, kCredentialBytesMax, expected);
  return Bio{BIO_new_mem_buf(text.data(), static_cast<int>(text.size()))};
}

Certificate read_certificate(const std::filesystem::path& file) {
  std::string text;
  const Bio bio = open_file(file, text, "a certificate (PEM)");
  Certificate certificate{PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr)};
  if (!certificate) refuse(file, std::string{"is not a certificate (PEM); "} + kMakeAgain);
  return certificate;
}

void require_private(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return;  // told when it is read
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) == 0) return;
  refuse(file,
         "the private key can be read or changed by other users; run chmod 600 on it, and if others may have "
         "copied it, make all credentials again");
}

int no_passphrase(char*, int, int, void*) { return 0; }

Key read_key(const std::filesystem::path& file) {
  require_private(file);
  std::string text;
  const Bio bio = open_file(file, text, "a private key (PEM)");
  Key key{PEM_read_bio_PrivateKey(bio.get(), nullptr, no_passphrase, nullptr)};
  OPENSSL_cleanse(text.data(), text.size());
  if (!key) refuse(file, std::string{"is not a private key (PEM, without a passphrase); "} + kMakeAgain);
  return key;
}

std::string time_text(const ASN1_TIME* time) {
  const Bio bio{BIO_new(BIO_s_mem())};
  ASN1_TIME_print(bio.get(), time);
  char* text = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &text);
  return {text, static_cast<std::size_t>(size)};
}

std::string name_entry(const X509& certificate, int entry) {
  std::array<char, 128> text{};
  const int size = X509_NAME_get_text_by_NID(X509_get_subject_name(&certificate), entry, text.data(), text.size());
  return size > 0 ? std::string{text.data(), static_cast<std::size_t>(size)} : std::string{};
}

void require_trusted(const std::filesystem::path& file, X509& certificate, X509& authority) {
  if (X509_cmp_current_time(X509_get0_notAfter(&certificate)) < 0) {
    refuse(file, "the certificate expired on " + time_text(X509_get0_notAfter(&certificate)) +
                     "; renew it with launch/security/make_credentials --renew, or correct the clock of this host");
  }
  if (X509_cmp_current_time(X509_get0_notBefore(&certificate)) > 0) {
    refuse(file, "the certificate is valid from " + time_text(X509_get0_notBefore(&certificate)) +
                     " on; correct the clock of this host");
  }
  const Store store{X509_STORE_new()};
  X509_STORE_add_cert(store.get(), &authority);
  const StoreContext context{X509_STORE_CTX_new()};
  X509_STORE_CTX_init(context.get(), store.get(), &certificate, nullptr);
  if (X509_verify_cert(context.get()) == 1) return;
  refuse(file, std::string{"the certificate was not issued by identity_ca.pem beside it ("} +
                   X509_verify_cert_error_string(X509_STORE_CTX_get_error(context.get())) +
                   "); all files of a folder must come from one run of launch/security/make_credentials");
}

void require_signed(const std::filesystem::path& file, X509& authority) {
  std::string text;
  const Bio bio = open_file(file, text, "a signed document (S/MIME)");
  BIO* content_of_it = nullptr;
  const Pkcs7 document{SMIME_read_PKCS7(bio.get(), &content_of_it)};
  const Bio content{content_of_it};
  if (!document) refuse(file, std::string{"is not a signed document (S/MIME); "} + kMakeAgain);
  const Store store{X509_STORE_new()};
  X509_STORE_add_cert(store.get(), &authority);
  const Bio verified{BIO_new(BIO_s_mem())};
  if (PKCS7_verify(document.get(), nullptr, store.get(), content.get(), verified.get(), PKCS7_TEXT) != 1) {
    refuse(file,
           "was changed, or was not signed by permissions_ca.pem beside it; all files of a folder must come from "
           "one run of launch/security/make_credentials");
  }
}

}  // namespace

Credentials credentials_in(const std::filesystem::path& folder) {
  const std::filesystem::path whole = std::filesystem::absolute(folder).lexically_normal();
  return {.identity_ca = whole / "identity_ca.pem",
          .permissions_ca = whole / "permissions_ca.pem",
          .certificate = whole / "certificate.pem",
          .private_key = whole / "private_key.pem",
          .governance = whole / "governance.p7s",
          .permissions = whole / "permissions.p7s"};
}

CredentialsOwner require_valid_credentials(const std::filesystem::path& folder) {
  const Credentials files = credentials_in(folder);
  const Certificate identity_ca = read_certificate(files.identity_ca);
  const Certificate permissions_ca = read_certificate(files.permissions_ca);
  const Certificate certificate = read_certificate(files.certificate);
  const Key key = read_key(files.private_key);
  require_trusted(files.certificate, *certificate, *identity_ca);
  if (X509_check_private_key(certificate.get(), key.get()) != 1) {
    refuse(files.private_key, "is not the key of certificate.pem beside it; copy the whole folder of one participant");
  }
  require_signed(files.governance, *permissions_ca);
  require_signed(files.permissions, *permissions_ca);
  return {.test = name_entry(*certificate, NID_organizationalUnitName),
          .participant = name_entry(*certificate, NID_commonName)};
}

void require_own_credentials(const std::filesystem::path& folder, std::string_view test, std::string_view participant) {
  const CredentialsOwner owner = require_valid_credentials(folder);
  if (owner.test == test && owner.participant == participant) return;
  refuse(folder, "these are the credentials of '" + owner.participant + "' in the test '" + owner.test +
                     "'; expected those of '" + std::string{participant} + "' in the test '" + std::string{test} + "'");
}

}  // namespace hybridtest::fast_dds
