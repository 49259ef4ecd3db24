import { askBytes } from '../wire/api';

/// Fetches with the key (a plain link could not carry it) and hands the bytes to the browser as a download.
export async function saveFile(path: string, name: string): Promise<void> {
  const url = URL.createObjectURL(await askBytes(path));
  const link = document.createElement('a');
  Object.assign(link, { href: url, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
